package sgraphs.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Line2D;
import java.io.IOException;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import sgraphs.lidar_points_t;
import sgraphs.velodyne_packets_t;

/** The newest whole scan from above, in the LiDAR's frame, coloured by height. */
class ScanView extends TopView {
  private static final double LOWEST_M = -1, HIGHEST_M = 2;

  private final String channel;
  private final boolean packets;
  private PointList growing = new PointList();
  private PointList shown = new PointList();
  private long number = -1;

  ScanView(String channel, boolean packets) {
    this.channel = channel;
    this.packets = packets;
    open("Scan of " + channel, channel);
  }

  @Override
  public void messageReceived(LCM lcm, String name, LCMDataInputStream stream) {
    try {
      if (packets)
        add(new velodyne_packets_t(stream));
      else
        add(new lidar_points_t(stream));
    } catch (IOException e) {
      System.err.println(name + ": a message that is of another type is left out (" + e.getMessage() + ")");
    }
  }

  private synchronized void add(velodyne_packets_t message) {
    if (message.part == 0) growing = new PointList();
    for (int i = 0; i < message.num_packets; ++i) Vlp16.decode(message.data, i * Vlp16.PACKET_BYTES, growing);
    if (message.last_part != 0) finish(message.revolution);
  }

  private synchronized void add(lidar_points_t message) {
    if (message.chunk == 0) growing = new PointList();
    ByteBuffer xyz = ByteBuffer.wrap(message.xyz).order(ByteOrder.LITTLE_ENDIAN);
    for (int i = 0; i < message.num_points; ++i)
      growing.add(xyz.getFloat(12 * i), xyz.getFloat(12 * i + 4), xyz.getFloat(12 * i + 8));
    if (message.chunk == message.num_chunks - 1) finish(message.sweep);
  }

  private void finish(long scan) {
    shown = growing;
    growing = new PointList();
    number = scan;
    touch();
  }

  @Override
  double[] extent() {
    return shown.extent();
  }

  @Override
  void drawPoints(PointPainter painter) {
    for (int i = 0; i < shown.size(); ++i) {
      double share = Math.min(1, Math.max(0, (shown.z(i) - LOWEST_M) / (HIGHEST_M - LOWEST_M)));
      int rgb = Color.HSBtoRGB((float) (0.66 * (1 - share)), 0.9f, 0.8f);
      painter.paint(shown.x(i), shown.y(i), rgb);
    }
  }

  @Override
  void drawShapes(Graphics2D g, double metresPerPixel) {
    // The sensor: x red, y green.
    g.setStroke(new BasicStroke((float) (2 * metresPerPixel)));
    g.setColor(Color.RED);
    g.draw(new Line2D.Double(0, 0, 1, 0));
    g.setColor(new Color(0, 140, 0));
    g.draw(new Line2D.Double(0, 0, 0, 1));
  }

  @Override
  String caption() {
    if (number < 0) return channel + ": waiting for a whole scan";
    return channel + ": scan " + number + ", " + shown.size() + " points, in lidar, blue " + LOWEST_M + " m to red "
        + HIGHEST_M + " m";
  }
}
