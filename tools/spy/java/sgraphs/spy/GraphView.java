package sgraphs.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Ellipse2D;
import java.awt.geom.Line2D;
import java.awt.geom.Path2D;
import java.io.IOException;
import java.util.ArrayList;
import java.util.List;
import java.util.Locale;
import java.util.Map;
import java.util.TreeMap;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import sgraphs.doorway_t;
import sgraphs.graph_node_t;
import sgraphs.graph_plane_t;
import sgraphs.graph_update_t;
import sgraphs.map_chunk_t;
import sgraphs.pose_t;
import sgraphs.room_t;
import sgraphs.rooms_t;

/** The situational graph from above: map points, walls, keyframes, rooms and doors. */
class GraphView extends TopView {
  private static final String UPDATE = "GRAPH_UPDATE", SNAPSHOT = "GRAPH_SNAPSHOT", ROOMS = "ROOMS", MAP = "MAP_CHUNK",
      POSE = "POSE";
  private static final int POINT_RGB = 0xB8B8B8;
  private static final Color WALL = new Color(200, 60, 30), KEYFRAME = new Color(30, 80, 200),
      DOOR = new Color(0, 140, 60), ROOM = new Color(255, 200, 60, 70), ROOM_LINE = new Color(160, 120, 0);

  private final Map<Long, graph_node_t> keyframes = new TreeMap<>();
  private final Map<Long, graph_plane_t> walls = new TreeMap<>();
  private final Map<Long, List<map_chunk_t>> map = new TreeMap<>();
  private final Map<Long, room_t> rooms = new TreeMap<>();
  private final Map<Long, doorway_t> doors = new TreeMap<>();
  private long round = -1, roomsRound = -1;
  private pose_t pose;

  GraphView() {
    open("Situational graph", UPDATE, SNAPSHOT, ROOMS, MAP, POSE);
  }

  @Override
  public void messageReceived(LCM lcm, String name, LCMDataInputStream stream) {
    try {
      synchronized (this) {
        if (name.equals(UPDATE) || name.equals(SNAPSHOT)) add(new graph_update_t(stream));
        if (name.equals(ROOMS)) add(new rooms_t(stream));
        if (name.equals(MAP)) add(new map_chunk_t(stream));
        if (name.equals(POSE)) pose = new pose_t(stream);
      }
      touch();
    } catch (IOException e) {
      System.err.println(name + ": a message that is of another type is left out (" + e.getMessage() + ")");
    }
  }

  private void add(graph_update_t message) {
    // Another run begins.
    if (message.round < round) {
      keyframes.clear();
      walls.clear();
      map.clear();
    }
    round = message.round;
    for (graph_node_t node : message.nodes)
      if (node.layer == graph_node_t.KEYFRAMES) keyframes.put(node.id, node);
    for (graph_plane_t plane : message.planes) {
      if (plane.merged_into >= 0)
        walls.remove(plane.id);
      else if (plane.label != graph_plane_t.HORIZONTAL)
        walls.put(plane.id, plane);
    }
  }

  private void add(rooms_t message) {
    // Each round's message holds all rooms, in chunks.
    if (message.round != roomsRound) {
      rooms.clear();
      doors.clear();
    }
    roomsRound = message.round;
    for (room_t room : message.rooms) rooms.put(room.id, room);
    for (doorway_t door : message.doorways) doors.put(door.id, door);
  }

  private void add(map_chunk_t message) {
    List<map_chunk_t> chunks = map.computeIfAbsent(message.keyframe, id -> new ArrayList<>());
    if (message.chunk == 0) chunks.clear();
    chunks.add(message);
  }

  @Override
  double[] extent() {
    double[] e = null;
    for (graph_node_t keyframe : keyframes.values()) e = including(e, keyframe.T_map_node.xyz);
    for (graph_plane_t wall : walls.values())
      for (float[] corner : wall.polygon) e = including(e, new double[] {corner[0], corner[1]});
    return e;
  }

  private static double[] including(double[] e, double[] p) {
    if (e == null) return new double[] {p[0], p[1], p[0], p[1]};
    PointList.include(e, p[0], p[1]);
    return e;
  }

  @Override
  void drawPoints(PointPainter painter) {
    for (Map.Entry<Long, List<map_chunk_t>> entry : map.entrySet()) {
      graph_node_t keyframe = keyframes.get(entry.getKey());
      if (keyframe == null) continue;
      double[] r = topRows(keyframe.T_map_node.wxyz);
      double[] t = keyframe.T_map_node.xyz;
      for (map_chunk_t chunk : entry.getValue()) {
        double unit = chunk.resolution_m;
        for (int i = 0; i + 2 < chunk.num_coordinates; i += 3) {
          double x = unit * chunk.xyz[i], y = unit * chunk.xyz[i + 1], z = unit * chunk.xyz[i + 2];
          painter.paint(t[0] + r[0] * x + r[1] * y + r[2] * z, t[1] + r[3] * x + r[4] * y + r[5] * z, POINT_RGB);
        }
      }
    }
  }

  /** The first two rows of the rotation matrix of a unit quaternion w, x, y, z. */
  private static double[] topRows(double[] q) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    return new double[] {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
        1 - 2 * (x * x + z * z), 2 * (y * z - w * x)};
  }

  @Override
  void drawShapes(Graphics2D g, double metresPerPixel) {
    g.setStroke(new BasicStroke((float) metresPerPixel));
    for (room_t room : rooms.values()) drawRoom(g, room);
    g.setStroke(new BasicStroke((float) (2 * metresPerPixel)));
    g.setColor(WALL);
    for (graph_plane_t wall : walls.values()) drawWall(g, wall);
    drawPath(g, metresPerPixel);
    g.setStroke(new BasicStroke((float) (2 * metresPerPixel)));
    g.setColor(DOOR);
    for (doorway_t door : doors.values())
      g.draw(circle(door.position[0], door.position[1], door.width_m / 2));
    if (pose == null) return;
    g.setColor(Color.RED);
    g.fill(circle(pose.pos[0], pose.pos[1], 6 * metresPerPixel));
  }

  private static Ellipse2D circle(double x, double y, double radius) {
    return new Ellipse2D.Double(x - radius, y - radius, 2 * radius, 2 * radius);
  }

  private static void drawRoom(Graphics2D g, room_t room) {
    Path2D outline = new Path2D.Double();
    for (int i = 0; i < room.num_corners; ++i) {
      double[] p = room.polygon[i];
      if (i == 0)
        outline.moveTo(p[0], p[1]);
      else
        outline.lineTo(p[0], p[1]);
    }
    outline.closePath();
    g.setColor(ROOM);
    g.fill(outline);
    g.setColor(ROOM_LINE);
    g.draw(outline);
    String text = String.format(Locale.ROOT, "r%d  %.1f m²", room.id, room.area_m2);
    drawText(g, text, room.center[0], room.center[1]);
  }

  /** A wall stands on its line: its extent's two ends along it. */
  private static void drawWall(Graphics2D g, graph_plane_t wall) {
    double ux = -wall.normal[1], uy = wall.normal[0];
    double least = Double.MAX_VALUE, most = -Double.MAX_VALUE;
    for (float[] corner : wall.polygon) {
      double along = ux * (corner[0] - wall.centroid[0]) + uy * (corner[1] - wall.centroid[1]);
      least = Math.min(least, along);
      most = Math.max(most, along);
    }
    if (least > most) return;
    double cx = wall.centroid[0], cy = wall.centroid[1];
    g.draw(new Line2D.Double(cx + least * ux, cy + least * uy, cx + most * ux, cy + most * uy));
  }

  private void drawPath(Graphics2D g, double metresPerPixel) {
    g.setColor(KEYFRAME);
    g.setStroke(new BasicStroke((float) metresPerPixel));
    graph_node_t previous = null;
    for (graph_node_t keyframe : keyframes.values()) {
      double[] p = keyframe.T_map_node.xyz;
      g.fill(circle(p[0], p[1], 3 * metresPerPixel));
      if (previous != null)
        g.draw(new Line2D.Double(previous.T_map_node.xyz[0], previous.T_map_node.xyz[1], p[0], p[1]));
      previous = keyframe;
    }
  }

  @Override
  String caption() {
    if (round < 0) return "waiting for " + UPDATE;
    return "round " + round + ": " + keyframes.size() + " keyframes, " + walls.size() + " walls, " + rooms.size()
        + " rooms, " + doors.size() + " doorways, in map";
  }
}
