#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/eval/graph_file.h"
#include "tools/eval/trajectory_error.h"
#include "tools/eval/wall_faces.h"

namespace sgraphs {

// An estimated wall that lies on a true face.
struct WallMatch {
  size_t face = 0;  // index in WallResult::faces
  size_t wall = 0;  // index in WallResult::walls
  double angle_rad = 0;
  double offset_m = 0;          // of the estimate's centroid from the face, positive on its visible side
  std::vector<size_t> claimed;  // samples of the face inside the estimate's polygon, ascending
};

struct WallResult {
  std::string missing;  // why walls were not judged; empty if they were
  std::vector<TrueFace> faces;
  std::vector<EstimatedWall> walls;  // the graph's vertical ones, in the building's frame
  std::vector<WallMatch> matches;    // by face, then wall
  std::vector<bool> found, doubled;  // of each face
  std::vector<size_t> false_walls;   // indices of walls
  ErrorStatistics angle_rad;         // over matches
  ErrorStatistics offset_m;

  // A face that was in view at least this long is asked for.
  static constexpr double kAskedAfter_s = 5;
  bool asked(size_t face) const { return faces[face].seen_s >= kAskedAfter_s; }
  struct Counts {
    size_t faces = 0, found = 0, missed = 0, doubled = 0;
  };
  // Of the faces asked for, or of the others. A doubled face is found, too.
  Counts counts(bool of_asked) const;
};

// `walls` in map. How a match, a double and a false wall are decided: docs/accuracy.md.
WallResult judgeWalls(const Plan& plan, const MeshQuery& mesh, const std::vector<StampedPose>& truth,
                      const std::vector<EstimatedWall>& walls, const SE3& T_truth_map);

// The wall as another frame sees it.
EstimatedWall moved(const EstimatedWall& wall, const SE3& T_other_map);

double polygonArea(const std::vector<Eigen::Vector3d>& polygon);

}  // namespace sgraphs
