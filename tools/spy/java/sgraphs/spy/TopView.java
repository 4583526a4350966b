package sgraphs.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.event.MouseAdapter;
import java.awt.event.MouseEvent;
import java.awt.event.MouseWheelEvent;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.awt.geom.AffineTransform;
import java.awt.image.BufferedImage;
import java.util.ArrayList;
import java.util.List;
import javax.swing.JFrame;
import javax.swing.JPanel;
import javax.swing.Timer;
import lcm.lcm.LCM;
import lcm.lcm.LCMSubscriber;

/**
 * A window onto the x-y plane of some frame, in metres, x to the right and y up. Drag to move, turn the wheel to zoom,
 * double-click to see everything again. Subclasses hear channels and draw.
 */
abstract class TopView extends JPanel implements LCMSubscriber {
  private static final int REFRESH_MS = 200;
  private static final double MARGIN = 0.05;

  private final List<String> channels = new ArrayList<>();
  private double centerX, centerY;
  private double pixelsPerMetre = 20;
  private boolean follow = true;
  private volatile boolean changed = true;

  TopView() {
    setPreferredSize(new Dimension(900, 700));
    setBackground(Color.WHITE);
    Mouse mouse = new Mouse();
    addMouseListener(mouse);
    addMouseMotionListener(mouse);
    addMouseWheelListener(mouse);
  }

  /** Smallest and largest x and y of what is drawn: {x0, y0, x1, y1}; null: nothing yet. Called with the lock held. */
  abstract double[] extent();

  /** Points of the background; called with the lock held. */
  abstract void drawPoints(PointPainter painter);

  /** Lines and areas over the points, in metres; called with the lock held. */
  abstract void drawShapes(Graphics2D g, double metresPerPixel);

  /** What stands in the corner. */
  abstract String caption();

  /** Opens a window that listens to the channels until it is closed. */
  void open(String title, String... names) {
    JFrame frame = new JFrame(title);
    frame.add(this);
    frame.pack();
    Timer timer = new Timer(REFRESH_MS, event -> {
      if (changed) {
        changed = false;
        repaint();
      }
    });
    frame.addWindowListener(new WindowAdapter() {
      @Override
      public void windowClosing(WindowEvent event) {
        timer.stop();
        for (String channel : channels) LCM.getSingleton().unsubscribe(channel, TopView.this);
        frame.dispose();
      }
    });
    frame.setDefaultCloseOperation(JFrame.DO_NOTHING_ON_CLOSE);
    for (String name : names) {
      channels.add(name);
      LCM.getSingleton().subscribe(name, this);
    }
    timer.start();
    frame.setVisible(true);
  }

  /** To be called when there is something new to draw. */
  void touch() {
    changed = true;
  }

  interface PointPainter {
    void paint(double x, double y, int rgb);
  }

  @Override
  protected synchronized void paintComponent(Graphics graphics) {
    super.paintComponent(graphics);
    if (follow) fit();
    Graphics2D g = (Graphics2D) graphics.create();
    BufferedImage image = new BufferedImage(Math.max(1, getWidth()), Math.max(1, getHeight()), BufferedImage.TYPE_INT_ARGB);
    drawPoints((x, y, rgb) -> {
      int column = (int) Math.floor(getWidth() / 2.0 + (x - centerX) * pixelsPerMetre);
      int row = (int) Math.floor(getHeight() / 2.0 - (y - centerY) * pixelsPerMetre);
      if (column >= 0 && column < image.getWidth() && row >= 0 && row < image.getHeight())
        image.setRGB(column, row, 0xFF000000 | rgb);
    });
    g.drawImage(image, 0, 0, null);
    g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
    g.setColor(Color.DARK_GRAY);
    g.drawString(caption(), 10, 20);
    drawScaleBar(g);
    AffineTransform toPixels = new AffineTransform();
    toPixels.translate(getWidth() / 2.0, getHeight() / 2.0);
    toPixels.scale(pixelsPerMetre, -pixelsPerMetre);
    toPixels.translate(-centerX, -centerY);
    g.transform(toPixels);
    drawShapes(g, 1 / pixelsPerMetre);
    g.dispose();
  }

  /** Text at a place in metres, readable although y points up. */
  static void drawText(Graphics2D g, String text, double x, double y) {
    AffineTransform before = g.getTransform();
    java.awt.geom.Point2D at = before.transform(new java.awt.geom.Point2D.Double(x, y), null);
    g.setTransform(new AffineTransform());
    int width = g.getFontMetrics().stringWidth(text);
    g.drawString(text, (float) at.getX() - width / 2f, (float) at.getY());
    g.setTransform(before);
  }

  private void drawScaleBar(Graphics2D g) {
    double length = Math.pow(10, Math.floor(Math.log10(getWidth() / 3.0 / pixelsPerMetre)));
    int pixels = (int) Math.round(length * pixelsPerMetre);
    g.setStroke(new BasicStroke(2));
    g.drawLine(10, getHeight() - 12, 10 + pixels, getHeight() - 12);
    g.drawString((length >= 1 ? String.valueOf((int) length) : String.valueOf(length)) + " m", 10, getHeight() - 18);
  }

  private void fit() {
    double[] e = extent();
    if (e == null) return;
    centerX = (e[0] + e[2]) / 2;
    centerY = (e[1] + e[3]) / 2;
    double width = Math.max(1, e[2] - e[0]) * (1 + 2 * MARGIN);
    double height = Math.max(1, e[3] - e[1]) * (1 + 2 * MARGIN);
    pixelsPerMetre = Math.min(getWidth() / width, getHeight() / height);
  }

  private class Mouse extends MouseAdapter {
    private int lastX, lastY;

    @Override
    public void mousePressed(MouseEvent event) {
      lastX = event.getX();
      lastY = event.getY();
    }

    @Override
    public void mouseDragged(MouseEvent event) {
      follow = false;
      centerX -= (event.getX() - lastX) / pixelsPerMetre;
      centerY += (event.getY() - lastY) / pixelsPerMetre;
      mousePressed(event);
      repaint();
    }

    @Override
    public void mouseWheelMoved(MouseWheelEvent event) {
      follow = false;
      pixelsPerMetre *= Math.pow(1.2, -event.getPreciseWheelRotation());
      repaint();
    }

    @Override
    public void mouseClicked(MouseEvent event) {
      if (event.getClickCount() == 2) follow = true;
      repaint();
    }
  }
}
