#include "perception/relocalise/relocalise_config.h"

namespace sgraphs {

void RelocaliseConfig::visit(ConfigVisitor& v) {
  v.field("search_spacing_m", search_spacing_m, 0.1, 100.0, "Path between two looks for the robot's place");
  v.field("min_looks", min_looks, 2, 100, "Looks that must prove one and the same pose");
  v.field("lead", lead, 1, 100,
          "Proven looks that it must be ahead of any other pose that is still possible");
  v.field("min_span_m", min_span_m, 1.5, 1000.0, "Path from the first to the last of them, at least");
  v.field("max_matches", max_matches, 2, 24, "Registrations of new matches per look at most");
  v.field("give_up_m", give_up_m, 10.0, 1e5, "Path after which a robot that is not found is lost");
}

}  // namespace sgraphs
