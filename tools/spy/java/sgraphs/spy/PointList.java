package sgraphs.spy;

import java.util.Arrays;

/** Points x, y, z [m] that grow. */
class PointList {
  private float[] xyz = new float[3 * 1024];
  private int size;

  void add(double x, double y, double z) {
    if (3 * size + 3 > xyz.length) xyz = Arrays.copyOf(xyz, 2 * xyz.length);
    xyz[3 * size] = (float) x;
    xyz[3 * size + 1] = (float) y;
    xyz[3 * size + 2] = (float) z;
    ++size;
  }

  int size() {
    return size;
  }

  double x(int i) {
    return xyz[3 * i];
  }

  double y(int i) {
    return xyz[3 * i + 1];
  }

  double z(int i) {
    return xyz[3 * i + 2];
  }

  /** {x0, y0, x1, y1}; null if there is no point. */
  double[] extent() {
    if (size == 0) return null;
    double[] e = {x(0), y(0), x(0), y(0)};
    for (int i = 1; i < size; ++i) include(e, x(i), y(i));
    return e;
  }

  static void include(double[] e, double x, double y) {
    e[0] = Math.min(e[0], x);
    e[1] = Math.min(e[1], y);
    e[2] = Math.max(e[2], x);
    e[3] = Math.max(e[3], y);
  }
}
