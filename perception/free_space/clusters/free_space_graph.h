#pragma once

#include <map>
#include <vector>

#include "common/types/free_space.h"
#include "perception/free_space/clusters/cluster_identity.h"
#include "perception/free_space/clusters/free_space_graph_config.h"
#include "perception/free_space/clusters/segmentation.h"

namespace sgraphs {

// Free space of all storeys as clusters, the passages between them, and a graph along the medial axis. Ids
// stay from call to call and are never used again.
class FreeSpaceGraph {
 public:
  explicit FreeSpaceGraph(const FreeSpaceGraphConfig& config) : config_(config) {}

  // Takes the place of what was known of the grids' storey. Both grids have the same layout. In `rooms`, what
  // stands in a room is free: clusters and passages are made of it. `navigation` has every obstacle: vertices
  // and edges are made of it.
  void update(const StoreyGrid& rooms, const StoreyGrid& navigation);

  // Round and time are the caller's to set.
  const FreeSpace& result() const { return result_; }

 private:
  struct Storey {
    ClusterIdentity identity;
    std::vector<Cut> cuts;
  };

  void updateClusters(const StoreyGrid& grid, const Segmentation& segmentation,
                      const std::vector<ClusterId>& ids);
  void updatePassages(const StoreyGrid& grid, const StoreyGrid& navigation, const Segmentation& segmentation,
                      const std::vector<ClusterId>& ids);
  void updateVertices(const StoreyGrid& rooms, const StoreyGrid& navigation, const Segmentation& segmentation,
                      const std::vector<ClusterId>& ids);

  FreeSpaceGraphConfig config_;
  std::map<FloorId, Storey> storeys_;
  FreeSpace result_;
  std::map<PassageId, int> found_;  // calls that found each living passage
  int64_t next_cluster_ = 0;
  int64_t next_passage_ = 0;
  int64_t next_vertex_ = 0;
};

}  // namespace sgraphs
