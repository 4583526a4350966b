package sgraphs.spy;

/** VLP-16 data packets (user manual 63-9243, chapter 9), as far as a picture needs them. */
final class Vlp16 {
  static final int PACKET_BYTES = 1206;
  private static final int BLOCKS = 12, BLOCK_BYTES = 100, LASERS = 16, CIRCLE = 36000;
  private static final int FLAG = 0xEEFF, DUAL = 0x39, MODE_AT = 1204;
  private static final double RANGE_STEP_M = 0.002;
  // From one firing of all lasers to the next, and from block to block [us].
  private static final double SEQUENCE_US = 55.296, BLOCK_US = 110.592, LASER_US = 2.304;

  private Vlp16() {}

  /** Appends the packet's returns in the LiDAR's frame: x ahead, y to the left, z up. */
  static void decode(byte[] data, int at, PointList points) {
    boolean dual = unsigned(data[at + MODE_AT]) == DUAL;
    int turn = turnPerBlock(data, at, dual);
    for (int block = 0; block < BLOCKS; ++block) {
      int begin = at + block * BLOCK_BYTES;
      if (word(data, begin) != FLAG) return;
      int azimuth = word(data, begin + 2);
      for (int channel = 0; channel < 2 * LASERS; ++channel) {
        double range = RANGE_STEP_M * word(data, begin + 4 + 3 * channel);
        if (range == 0) continue;
        int laser = channel % LASERS;
        double since = channel / LASERS * SEQUENCE_US + laser * LASER_US;
        double turned = Math.toRadians((azimuth + turn * since / BLOCK_US) / 100);
        double up = Math.toRadians(laser % 2 == 0 ? laser - 15 : laser);
        points.add(range * Math.cos(up) * Math.cos(turned), -range * Math.cos(up) * Math.sin(turned),
            range * Math.sin(up));
      }
    }
  }

  /** In hundredths of a degree; blocks of a pair share their azimuth in dual mode. */
  private static int turnPerBlock(byte[] data, int at, boolean dual) {
    int next = dual ? 2 : 1;
    int turn = word(data, at + next * BLOCK_BYTES + 2) - word(data, at + 2);
    return (turn + CIRCLE) % CIRCLE;
  }

  private static int word(byte[] data, int at) {
    return unsigned(data[at]) | unsigned(data[at + 1]) << 8;
  }

  private static int unsigned(byte value) {
    return value & 0xFF;
  }
}
