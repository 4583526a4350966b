#include "backend/output/run_outputs.h"

#include <stdexcept>

#include "backend/output/dense_trajectory.h"
#include "backend/output/summary_json.h"
#include "common/io/text_file.h"

namespace sgraphs {

void writeOutputs(const RunRecord& record, const std::string& out_dir) {
  if (!record.graph) throw std::logic_error("writeOutputs: the record has no graph");
  createFolder(out_dir);
  writeTum(out_dir + "/trajectory.tum", denseTrajectory(*record.graph, record.scans));
  writeTum(out_dir + "/keyframes.tum", keyframeTrajectory(*record.graph));
  writeTum(out_dir + "/odometry.tum", odometryTrajectory(record.scans));
  writeFile(out_dir + "/summary.json", summaryJson(record));
}

}  // namespace sgraphs
