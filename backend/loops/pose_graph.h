#pragma once

#include <map>

#include "backend/graph/situational_graph.h"

namespace sgraphs {

// The keyframes by relative poses and `up` alone, without walls and rooms: where a loop mends a drift of
// metres, walls that were matched or doubled under that drift would hold the old shape.
// The shape as it is now is bent, by as little as its relative poses' covariances allow, until the active
// loops close (quadratically: they are taken for true).
std::map<KeyframeId, SE3> bentToLoops(const SituationalGraph& graph);

// The same by the measured relative poses: as if there had never been another shape.
std::map<KeyframeId, SE3> poseGraphOptimum(const SituationalGraph& graph);

// Of the pose of keyframe `of` relative to every other (tangent of body of `of`), along the best single way
// of relative poses: never smaller than what they say together. Keyframes that no way leads to are missing.
std::map<KeyframeId, Matrix6d> covariancesAlongBestWay(const SituationalGraph& graph, KeyframeId of);

}  // namespace sgraphs
