#include "perception/stage/map_update_input.h"

#include "lcmtypes/convert/convert_layers.h"

namespace sgraphs {

std::optional<MapUpdate> MapUpdateInput::add(const graph_update_t& m) {
  if (!io_.accept(channels::kGraphUpdate, m) || !io_.takesPart()) return std::nullopt;
  bool refused = false;
  const auto chunks = assembly_.add(m, refused);
  if (refused) io_.reject(channels::kGraphUpdate, "a round that cannot be, or chunks that do not match");
  if (!chunks) return std::nullopt;
  std::optional<MapUpdate> update = fromMessages(*chunks);
  if (!update) io_.reject(channels::kGraphUpdate, "content that cannot be right");
  return update;
}

}  // namespace sgraphs
