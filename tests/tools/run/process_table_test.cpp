#include "tools/run/process_table.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tools/system/stages.h"

namespace sgraphs {
namespace {

using Role = ProcessRow::Role;

RunOptions optionsOf() {
  RunOptions options;
  options.out_dir = "OUT";
  options.lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  options.programs_dir = "/nowhere";
  return options;
}

const ProcessRow* find(const std::vector<ProcessRow>& rows, const std::string& name) {
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const ProcessRow& r) { return r.name == name; });
  return row == rows.end() ? nullptr : &*row;
}

std::string line(const ProcessRow& row) {
  std::string text;
  for (const std::string& word : row.command) text += (text.empty() ? "" : " ") + word;
  return text;
}

TEST(ProcessTableTest, EveryStageOfSessionHasItsProcess) {
  const auto rows = processTable(optionsOf(), "");
  for (const std::string& stage : allStages()) {
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const ProcessRow& r) { return r.stage == stage; });
    ASSERT_NE(row, rows.end()) << stage;
    EXPECT_EQ(row->command.front(), "sgraphs-" + stage);
    EXPECT_FALSE(row->status_channel.empty());
  }
  EXPECT_EQ(line(*find(rows, "backend")),
            "sgraphs-backend --lcm-url udpm://239.255.76.67:7667?ttl=0 --state-dir OUT/state --live -o OUT");
}

TEST(ProcessTableTest, SettingsReachEveryProcessOfOurs) {
  RunOptions options = optionsOf();
  options.config_file = "c.yaml";
  options.assignments = {"live.deadline_s=1"};
  for (const ProcessRow& row : processTable(options, ""))
    EXPECT_NE(line(row).find("--config c.yaml --set live.deadline_s=1"), std::string::npos) << row.name;
}

TEST(ProcessTableTest, ASensorAndARobotAreSourcesThatLeaveSessionToTheRun) {
  RunOptions options = optionsOf();
  options.spot_host = "192.168.80.3";
  const auto rows = processTable(options, "");
  ASSERT_TRUE(find(rows, "velodyne-driver"));
  EXPECT_EQ(find(rows, "velodyne-driver")->role, Role::kSource);
  EXPECT_NE(line(*find(rows, "velodyne-driver")).find("--no-session"), std::string::npos);
  ASSERT_TRUE(find(rows, "spot-bridge"));
  EXPECT_NE(line(*find(rows, "spot-bridge")).find("--host 192.168.80.3"), std::string::npos);
  EXPECT_FALSE(find(processTable(optionsOf(), ""), "spot-bridge"));
}

TEST(ProcessTableTest, ACaptureAndALogComeToAnEnd) {
  RunOptions capture = optionsOf();
  capture.pcap = "lidar.pcap";
  EXPECT_EQ(find(processTable(capture, ""), "velodyne-driver")->role, Role::kPlayer);
  RunOptions log = optionsOf();
  log.log = "run.lcmlog";
  log.rate = 2;
  const auto rows = processTable(log, "");
  EXPECT_FALSE(find(rows, "velodyne-driver"));
  EXPECT_EQ(line(*find(rows, "player")),
            "lcm-logplayer -s 2 -e VELODYNE_PACKETS|LIDAR_POINTS|SPOT_ODOMETRY -l "
            "udpm://239.255.76.67:7667?ttl=0 run.lcmlog");
}

TEST(ProcessTableTest, TheRecorderTakesTheRawChannelsOrAll) {
  RunOptions options = optionsOf();
  EXPECT_FALSE(find(processTable(options, ""), "recorder"));
  EXPECT_NE(line(*find(processTable(options, "DIR/x.lcmlog"), "recorder"))
                .find("-c SESSION|VELODYNE_PACKETS|LIDAR_POINTS|SPOT_ODOMETRY|ROUND_SCHEDULE|STREAM_END|"),
            std::string::npos);
  options.record_all = true;
  EXPECT_NE(line(*find(processTable(options, "DIR/x.lcmlog"), "recorder")).find("-c .* "), std::string::npos);
}

}  // namespace
}  // namespace sgraphs
