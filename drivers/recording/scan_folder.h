#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "drivers/recording/sweep_source.h"

namespace sgraphs {

// A folder of scans in the lidar frame (.pcd, .ply, KITTI .bin: float32 x y z intensity) and times.txt with
// one time [s] per scan, in order of the files' names. The scans count as deskewed to their times.
class ScanFolder : public SweepSource {
 public:
  // Throws Error if there is no scan, or times and scans do not agree.
  explicit ScanFolder(const std::string& path);

  // Next scan; nothing at the end. Points that are not finite are left out. Throws Error for a file that
  // cannot be read or holds no x, y, z.
  std::optional<LidarScan> next() override;

  const std::vector<std::string>& files() const { return files_; }
  std::string timesFile() const;
  std::string whyNothing() const override { return "folder '" + path_ + "' holds no scan"; }
  double progress() const override { return static_cast<double>(next_) / static_cast<double>(files_.size()); }

 private:
  void readTimes();

  std::string path_;
  std::vector<std::string> files_;
  std::vector<Time> times_;
  size_t next_ = 0;
};

// Points of one file, by its extension. Throws Error naming the file.
std::vector<Eigen::Vector3f> readPoints(const std::string& path);

}  // namespace sgraphs
