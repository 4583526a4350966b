#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/io/ply.h"
#include "tools/eval/evaluate.h"
#include "tools/eval/plan_view.h"

namespace sgraphs {

// PNG files, in the building's frame. A picture without anything to show is an empty string.
std::string errorPlot(const Evaluation& evaluation, const Truth& truth);  // error over time
// Over the walls at 1 m height.
std::string trajectoryPlot(const Evaluation& evaluation, const Truth& truth, Storey storey);
// The map coloured by its error.
std::string mapPlot(const Evaluation& evaluation, const Truth& truth, Storey storey);
// True walls grey; their faces as they were found, missed or doubled; estimated walls on top, false ones
// marked.
std::string wallPlot(const Evaluation& evaluation, const Truth& truth, Storey storey);
// One storey's true rooms outlined, found ones filled, false ones hatched; doorways as ticks.
std::string roomPlot(const Evaluation& evaluation, const Truth& truth, size_t storey);

// All that have something to show, by the name of their file: eval_map.png, or eval_map_0.png,
// eval_map_1.png, … where the building has several storeys.
std::vector<std::pair<std::string, std::string>> evaluationPlots(const Evaluation& evaluation,
                                                                 const Truth& truth);

// Where a mesh crosses a height, seen from above.
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> sliceMesh(const TriangleMesh& mesh, double z_m);

}  // namespace sgraphs
