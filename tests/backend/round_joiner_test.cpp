#include "backend/round_joiner.h"

#include <gtest/gtest.h>

namespace sgraphs {
namespace {

using Output = RoundJoiner::Output;

TEST(RoundJoinerTest, ARoundIsReadyWhenEveryInputOfItsKeyIsThereInAnyOrder) {
  RoundJoiner joiner;
  const RoundJoiner::Wants wants{{"KEYFRAME", 3}, {"ROOMS", 9}};
  EXPECT_FALSE(joiner.ready(10, wants));
  EXPECT_TRUE(joiner.arrived({"ROOMS", 9, 40}));
  EXPECT_TRUE(joiner.arrived({"KEYFRAME", 4, 51}));  // the next round's, early
  EXPECT_FALSE(joiner.ready(10, wants));
  EXPECT_TRUE(joiner.arrived({"KEYFRAME", 3, 50}));
  ASSERT_TRUE(joiner.ready(10, wants));
  const auto joined = joiner.take(10, wants);
  EXPECT_EQ(joined.outputs, (std::vector<Output>{{"KEYFRAME", 3, 50}, {"ROOMS", 9, 40}}));
  EXPECT_TRUE(joined.missing.empty());
  EXPECT_TRUE(joiner.ready(11, {{"KEYFRAME", 4}}));
}

TEST(RoundJoinerTest, ALostInputDoesNotHoldTheRound) {
  RoundJoiner joiner;
  const RoundJoiner::Wants wants{{"KEYFRAME", 0}, {"KEYFRAME_PLANES", 0}};
  joiner.arrived({"KEYFRAME", 0, 0});
  EXPECT_FALSE(joiner.ready(0, wants));
  joiner.lost("KEYFRAME_PLANES", 0);
  ASSERT_TRUE(joiner.ready(0, wants));
  const auto joined = joiner.take(0, wants);
  EXPECT_EQ(joined.outputs.size(), 1u);
  EXPECT_EQ(joined.missing, std::vector<std::string>{"KEYFRAME_PLANES"});
}

TEST(RoundJoinerTest, AnOutputOfAClosedRoundIsRefusedInWaitMode) {
  RoundJoiner joiner;
  joiner.lost("KEYFRAME", 0);
  joiner.take(0, {{"KEYFRAME", 0}});
  EXPECT_FALSE(joiner.arrived({"KEYFRAME", 0, 0}));
}

TEST(RoundJoinerTest, AnOutputOfAClosedRoundJoinsTheNextInLiveMode) {
  RoundJoiner joiner(RoundJoiner::Mode::kLive);
  joiner.take(0, {{"ROOMS", 0}});  // the deadline passed
  EXPECT_TRUE(joiner.arrived({"ROOMS", 0, 0}));
  EXPECT_TRUE(joiner.arrived({"ROOMS", 1, 1}));
  const auto joined = joiner.take(1, {{"ROOMS", 1}});
  EXPECT_EQ(joined.outputs, (std::vector<Output>{{"ROOMS", 0, 0}, {"ROOMS", 1, 1}}));
}

TEST(RoundJoinerTest, ARecordedScheduleIsObeyedInPlaceOfTheKeys) {
  RoundJoiner joiner;
  joiner.schedule(0, {{"KEYFRAME", -1, 0}});
  joiner.schedule(1, {{"KEYFRAME", -1, 1}, {"ROOMS", -1, 0}});
  joiner.arrived({"ROOMS", 0, 0});
  joiner.arrived({"KEYFRAME", 0, 0});
  const auto first = joiner.take(0, {{"KEYFRAME", 0}, {"ROOMS", 0}});
  EXPECT_EQ(first.outputs, (std::vector<Output>{{"KEYFRAME", 0, 0}}));
  EXPECT_FALSE(joiner.ready(1, {{"KEYFRAME", 1}}));
  joiner.arrived({"KEYFRAME", 1, 1});
  ASSERT_TRUE(joiner.ready(1, {{"KEYFRAME", 1}}));
  EXPECT_EQ(joiner.take(1, {{"KEYFRAME", 1}}).outputs.size(), 2u);
}

TEST(RoundJoinerTest, AScheduledOutputThatWasOvertakenCountsAsMissing) {
  RoundJoiner joiner;
  joiner.schedule(0, {{"ROOMS", -1, 4}});
  EXPECT_FALSE(joiner.ready(0, {}));
  joiner.arrived({"ROOMS", 6, 5});
  ASSERT_TRUE(joiner.ready(0, {}));
  EXPECT_EQ(joiner.take(0, {}).missing, std::vector<std::string>{"ROOMS"});
}

TEST(RoundJoinerTest, TheSameOutputTwiceIsRefused) {
  RoundJoiner joiner;
  EXPECT_TRUE(joiner.arrived({"KEYFRAME", 0, 0}));
  EXPECT_FALSE(joiner.arrived({"KEYFRAME", 0, 1}));
}

TEST(RoundJoinerTest, HeldOutputsAreBounded) {
  RoundJoiner joiner;
  for (int64_t key = 0; key < static_cast<int64_t>(RoundJoiner::kMaxHeld); ++key)
    ASSERT_TRUE(joiner.arrived({"ROOMS", key, key}));
  EXPECT_FALSE(joiner.arrived({"ROOMS", 1 << 20, 1 << 20}));
}

}  // namespace
}  // namespace sgraphs
