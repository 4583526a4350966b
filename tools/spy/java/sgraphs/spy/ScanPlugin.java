package sgraphs.spy;

import java.awt.event.ActionEvent;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import sgraphs.lidar_points_t;
import sgraphs.velodyne_packets_t;

/** Shows scans of a LiDAR when their channel is double-clicked. */
public class ScanPlugin implements SpyPlugin {
  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == velodyne_packets_t.LCM_FINGERPRINT || fingerprint == lidar_points_t.LCM_FINGERPRINT;
  }

  /** lcm-spy also asks with nulls, for the name alone. */
  @Override
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return new AbstractAction("Scan from above") {
      @Override
      public void actionPerformed(ActionEvent event) {
        new ScanView(channel.name, channel.fingerprint == velodyne_packets_t.LCM_FINGERPRINT);
      }
    };
  }
}
