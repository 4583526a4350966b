#include "common/bus/channels.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

namespace sgraphs {
namespace {

namespace fs = std::filesystem;

template <typename Message>
void expectRow(const Channel<Message>& channel, bool raw) {
  const channels::Row* row = channels::find(channel.name);
  ASSERT_NE(row, nullptr) << channel.name;
  EXPECT_STREQ(row->type, Message::getTypeName()) << channel.name;
  EXPECT_EQ(row->raw, raw) << channel.name;
}

TEST(ChannelsTest, TheTableAgreesWithTheTypedChannels) {
  using namespace channels;
  expectRow(kSession, true);
  expectRow(kVelodynePackets, true);
  expectRow(kLidarPoints, true);
  expectRow(kSpotOdometry, true);
  expectRow(kRoundSchedule, true);
  expectRow(kStreamEnd, true);
  expectRow(kStatusVelodyneDriver, false);
  expectRow(kPoseSpot, false);
  expectRow(kOdometry, false);
  expectRow(kPoseOdom, false);
  expectRow(kKeyframe, false);
  expectRow(kOdometryEnd, false);
  expectRow(kKeyframePlanes, false);
  expectRow(kPlanesEnd, false);
  expectRow(kGraphUpdate, false);
  expectRow(kGraphSnapshot, false);
  expectRow(kMapToOdom, false);
  expectRow(kPose, false);
  expectRow(kRunResult, false);
  expectRow(kStatusOdometry, false);
  expectRow(kStatusPlanes, false);
  expectRow(kFreeSpace, false);
  expectRow(kRooms, false);
  expectRow(kLoopClosures, false);
  expectRow(kMapChunk, false);
  expectRow(kStatusFreeSpace, false);
  expectRow(kStatusRooms, false);
  expectRow(kStatusLoops, false);
  expectRow(kStatusBackend, false);
  expectRow(kStatusSpotBridge, false);
  EXPECT_EQ(table().size(), 30u);
}

TEST(ChannelsTest, NamesAreUniqueAndCarriedByLcm) {
  std::set<std::string> names;
  for (const channels::Row& row : channels::table()) {
    const std::string name = row.name;
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_LE(name.size(), 63u);
    EXPECT_EQ(name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_"), std::string::npos) << name;
  }
}

TEST(ChannelsTest, EveryTypeIsDefinedInItsFile) {
  for (const channels::Row& row : channels::table())
    EXPECT_TRUE(fs::exists(fs::path(SGRAPHS_SOURCE_DIR) / "lcmtypes" / (std::string(row.type) + ".lcm")))
        << row.type;
}

TEST(ChannelsTest, UnknownNamesHaveNoRow) {
  EXPECT_EQ(channels::find("POSES"), nullptr);
  EXPECT_EQ(channels::find(""), nullptr);
}

}  // namespace
}  // namespace sgraphs
