package sgraphs.spy;

import java.awt.event.ActionEvent;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import sgraphs.graph_update_t;
import sgraphs.map_chunk_t;
import sgraphs.rooms_t;

/** Shows map and graph when one of the channels that they come by is double-clicked. */
public class GraphPlugin implements SpyPlugin {
  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == graph_update_t.LCM_FINGERPRINT || fingerprint == rooms_t.LCM_FINGERPRINT
        || fingerprint == map_chunk_t.LCM_FINGERPRINT;
  }

  /** lcm-spy also asks with nulls, for the name alone. */
  @Override
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return new AbstractAction("Map and graph from above") {
      @Override
      public void actionPerformed(ActionEvent event) {
        new GraphView();
      }
    };
  }
}
