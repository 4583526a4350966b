#pragma once

#include "common/config/config_io.h"
#include "perception/free_space/clusters/free_space_graph_config.h"
#include "perception/free_space/evidence_config.h"

namespace sgraphs {

// Members are listed once, in visit(); see config_io.h.
struct FreeSpaceConfig {
  EvidenceConfig evidence;
  FreeSpaceGraphConfig graph;

  void visit(ConfigVisitor& v) {
    v.section("evidence", evidence, "Rays to what is free and what stands in the way");
    v.section("graph", graph, "Clusters, the passages between them, and the graph along the medial axis");
  }
};

}  // namespace sgraphs
