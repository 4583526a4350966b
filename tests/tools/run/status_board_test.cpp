#include "tools/run/status_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgraphs {
namespace {

using ::testing::HasSubstr;

status_t statusOf(const std::string& process, const std::string& state) {
  status_t m{};
  m.process = process;
  m.state = state;
  m.lost = {0, 2};
  m.rejected = {1, 0};
  m.queue_depth = 4;
  m.step_p50_us = 9330;
  m.step_p99_us = 42490;
  m.resident_bytes = int64_t{90} << 20;
  return m;
}

TEST(StatusBoardTest, TheSummaryTellsWhatTheRunHasComeTo) {
  StatusBoard board;
  board.takeRates(10);
  for (int i = 0; i < 20; ++i) board.count("ODOMETRY");
  for (int i = 0; i < 100; ++i) board.count("SPOT_ODOMETRY");
  board.takeRates(12);
  graph_update_t update{};
  update.round = 7;
  update.keyframe = 6;
  board.graphUpdate(update);
  rooms_t rooms{};
  rooms.num_rooms = 2;
  rooms.num_doorways = 3;
  rooms.num_floors = 1;
  board.rooms(rooms);
  board.rooms(rooms);  // the next round's: not more of them
  board.status("STATUS_ROOMS", statusOf("sgraphs-rooms", "running"), 12);
  EXPECT_EQ(board.summary(3723),
            "01:02:03  scans 10.0/s  legs 50/s  keyframes 7  rounds 8  rooms 2  doorways 3  floors 1  lost 2 "
            " 90 MiB");
}

TEST(StatusBoardTest, TheScreenHasARowPerProcess) {
  StatusBoard board;
  board.status("STATUS_ROOMS", statusOf("sgraphs-rooms", "running"), 5);
  const auto lines = board.screen(6, {{"STATUS_ROOMS", 3}});
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[3],
            "sgraphs-rooms                  4      9.33     42.49      2        1     90         3  running");
}

TEST(StatusBoardTest, AProcessThatIsNotHeardOfIsToldFrom) {
  StatusBoard board;
  board.status("STATUS_ROOMS", statusOf("sgraphs-rooms", "running"), 5);
  EXPECT_THAT(board.screen(7, {}).back(), HasSubstr("running"));
  EXPECT_THAT(board.screen(15, {}).back(), HasSubstr("not heard of for 10 s"));
}

}  // namespace
}  // namespace sgraphs
