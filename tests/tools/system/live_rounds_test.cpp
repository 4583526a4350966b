// Rounds with a deadline, and the playback of what they were: a source, the feedback stages and the backend,
// with small cores. The stages here answer when the test says so, as processes do that are stopped for a
// while.
#include <gtest/gtest.h>

#include <set>

#include "backend/backend_node.h"
#include "tests/tools/system/bus_recorder.h"
#include "tests/tools/system/fake_cores.h"

namespace sgraphs {
namespace {

using testing::FakeBackend;
using testing::FakeOdometry;
using testing::kWithoutLoops;
using testing::Recorder;
using testing::Source;

struct Sent {
  std::string channel;
  std::vector<uint8_t> bytes;
};

// What sgraphs-odometry says of a walk: a keyframe every third scan.
std::vector<Sent> upstreamOf(int scans, const std::vector<std::string>& stages) {
  MemoryBus bus;
  std::vector<Sent> sent;
  for (const char* channel : {"SESSION", "ODOMETRY", "KEYFRAME", "ODOMETRY_END"})
    bus.subscribe(channel, [&sent, channel](Bus::Bytes b) {
      sent.push_back({channel, {b.begin(), b.end()}});
    });
  OdometryNode odometry(bus, partsOf(std::make_shared<FakeOdometry>()));
  Source source(bus);
  source.session("lidar", false, stages);
  for (int s = 0; s < scans; ++s) source.packet(0.1 * s);
  source.end();
  return sent;
}

// The backend of one run with the stages "free-space" and "rooms", whose answers are functions of the map
// they answer, so that the digest shows which answers a round was given.
class BackendRun {
 public:
  explicit BackendRun(RoundJoiner::Mode mode) : node(bus, coreOf(core), mode) {
    subscribe(
        bus, channels::kGraphUpdate, [this](const graph_update_t& m) { asked.push_back(m); }, [] {});
    core->digest_of = [](const RoundInput& input) {
      return std::to_string(input.free_space ? input.free_space->round : -1) + "/" +
             std::to_string(input.rooms ? input.rooms->round : -1);
    };
  }
  void play(const Sent& sent) {
    bus.publish(sent.channel, sent.bytes);
    bus.dispatch(0);
  }
  void play(const std::vector<Sent>& stream) {
    for (const Sent& sent : stream) play(sent);
  }
  void play(const round_schedule_t& m) {
    publish(bus, channels::kRoundSchedule, m);
    bus.dispatch(0);
  }
  // Both stages answer the oldest update that has no answer yet.
  void answerOne() { answerFreeSpace(), answerRooms(); }
  void answerFreeSpace() {
    free_space_t m{};
    const graph_update_t update = asked.at(static_cast<size_t>(free_space_answers_));
    m.header = {7, 0, free_space_answers_++, update.header.utime};
    m.round = update.round;
    m.num_chunks = 1;
    publish(bus, channels::kFreeSpace, m);
    bus.dispatch(0);
  }
  void answerRooms() {
    rooms_t m{};
    const graph_update_t update = asked.at(static_cast<size_t>(rooms_answers_));
    m.header = {7, 0, rooms_answers_++, update.header.utime};
    m.round = update.round;
    m.num_chunks = 1;
    publish(bus, channels::kRooms, m);
    bus.dispatch(0);
  }
  void answerAll() {
    while (free_space_answers_ < std::ssize(asked) || rooms_answers_ < std::ssize(asked)) {
      if (free_space_answers_ < std::ssize(asked)) answerFreeSpace();
      if (rooms_answers_ < std::ssize(asked)) answerRooms();
    }
  }

  MemoryBus bus;
  std::shared_ptr<FakeBackend> core = std::make_shared<FakeBackend>();
  Recorder<round_schedule_t> schedules{bus, channels::kRoundSchedule};
  std::vector<graph_update_t> asked;
  BackendNode node;

 private:
  int64_t free_space_answers_ = 0, rooms_answers_ = 0;
};

const std::vector<std::string> kLiveStages = {"odometry", "free-space", "rooms", "backend", "schedule"};

// A walk of 24 scans in which both stages are silent from the fourth round to the seventh; then they answer
// everything.
void liveWalk(BackendRun& live, const std::vector<std::string>& stages = kLiveStages) {
  for (const Sent& sent : upstreamOf(24, stages)) {
    live.play(sent);
    const size_t round = live.asked.size();
    const bool silent = round >= 4 && round <= 7;
    if (!silent) live.answerAll();
    if (silent && live.node.awaitedRound() >= 0) live.node.leaveOutAwaited();
  }
  live.answerAll();
  ASSERT_TRUE(live.node.done());
}

TEST(LiveRoundsTest, LateAnswersOfSeveralRoundsJoinOneAndNothingIsLost) {
  BackendRun live(RoundJoiner::Mode::kLive);
  liveWalk(live);
  const auto& inputs = live.core->inputs;
  ASSERT_EQ(inputs.size(), 8u + BackendNode::kQuietRounds);
  EXPECT_EQ(inputs[3].rooms->round, 2);
  for (const size_t round : {4u, 5u, 6u}) {
    EXPECT_FALSE(inputs[round].rooms) << round;
    EXPECT_EQ(inputs[round].free_space->round, 2) << "the newest that is known";
  }
  EXPECT_EQ(live.node.leftOut(), 2 * 4);
  EXPECT_EQ(live.schedules.messages.size(), inputs.size());
  std::set<int64_t> joined;
  for (const round_schedule_t& m : live.schedules.messages)
    for (size_t i = 0; i < m.channel.size(); ++i)
      if (m.channel[i] == "ROOMS") {
        EXPECT_TRUE(joined.insert(m.seq[i]).second) << "joined twice";
      }
  EXPECT_EQ(joined.size(), inputs.size() - 1) << "every answer but that to the last round joined one";
  EXPECT_EQ(live.node.result().why_not, "") << "a recorded deadline is no reason against reproducing";
}

TEST(LiveRoundsTest, APlaybackThatKnowsTheSchedulesObeysThem) {
  BackendRun live(RoundJoiner::Mode::kLive);
  liveWalk(live);
  BackendRun playback(RoundJoiner::Mode::kWait);
  const std::vector<Sent> stream = upstreamOf(24, kLiveStages);
  playback.play(stream.front());
  for (const round_schedule_t& m : live.schedules.messages) playback.play(m);
  for (const Sent& sent : stream) {
    if (sent.channel != "SESSION") playback.play(sent);
    playback.answerAll();
  }
  ASSERT_TRUE(playback.node.done());
  EXPECT_EQ(playback.node.result().graph_digest, live.node.result().graph_digest);
  EXPECT_EQ(playback.node.result().why_not, "");
}

// Regression: lcm-logplayer brings a round's schedule when the round ran live, long after the round's inputs
// are there.
TEST(LiveRoundsTest, APlaybackWaitsForAScheduleThatComesAfterTheInputs) {
  BackendRun live(RoundJoiner::Mode::kLive);
  liveWalk(live);
  BackendRun playback(RoundJoiner::Mode::kWait);
  playback.play(upstreamOf(24, kLiveStages));
  EXPECT_EQ(playback.core->inputs.size(), 0u);
  EXPECT_EQ(playback.node.awaitedRound(), 0);
  for (const round_schedule_t& m : live.schedules.messages) {
    playback.answerAll();
    playback.play(m);
  }
  playback.answerAll();
  ASSERT_TRUE(playback.node.done());
  EXPECT_EQ(playback.node.result().graph_digest, live.node.result().graph_digest);
  EXPECT_EQ(playback.node.result().why_not, "");
}

TEST(LiveRoundsTest, WithoutTheSchedulesTheDigestIsAnother) {
  BackendRun live(RoundJoiner::Mode::kLive);
  liveWalk(live);
  BackendRun other(RoundJoiner::Mode::kWait);
  for (const Sent& sent : upstreamOf(24, kWithoutLoops)) {
    other.play(sent);
    other.answerAll();
  }
  ASSERT_TRUE(other.node.done());
  EXPECT_NE(other.node.result().graph_digest, live.node.result().graph_digest);
}

TEST(LiveRoundsTest, AScheduleThatIsLostIsGivenUpAndNamed) {
  BackendRun live(RoundJoiner::Mode::kLive);
  liveWalk(live);
  BackendRun playback(RoundJoiner::Mode::kWait);
  playback.play(upstreamOf(24, kLiveStages));
  for (const round_schedule_t& m : live.schedules.messages) {
    playback.answerAll();
    if (m.round != 3 && m.round != live.schedules.messages.back().round) playback.play(m);
  }
  playback.answerAll();
  EXPECT_FALSE(playback.node.done());
  EXPECT_GE(playback.node.awaitedRound(), 0);
  for (int i = 0; i < 5 && !playback.node.done(); ++i) {
    playback.node.giveUpAwaited();
    playback.answerAll();
  }
  ASSERT_TRUE(playback.node.done());
  EXPECT_EQ(playback.node.result().why_not,
            "1 message(s) of ROUND_SCHEDULE lost; 1 ROUND_SCHEDULE incomplete when their round ran");
}

TEST(LiveRoundsTest, AScheduleThatAsksForWhatIsLostEndsWithTheReason) {
  BackendRun live(RoundJoiner::Mode::kLive);
  liveWalk(live);
  BackendRun playback(RoundJoiner::Mode::kWait);
  playback.play(upstreamOf(24, kLiveStages));
  for (const round_schedule_t& m : live.schedules.messages) playback.play(m);
  for (int i = 0; i < 20 && !playback.node.done(); ++i) {
    if (std::ssize(playback.asked) > i) playback.answerFreeSpace();  // the rooms never say anything
    playback.node.giveUpAwaited();
  }
  ASSERT_TRUE(playback.node.done());
  EXPECT_NE(playback.node.result().why_not.find("ROOMS incomplete when their round ran"), std::string::npos)
      << playback.node.result().why_not;
}

TEST(LiveRoundsTest, AfterTheEndOfTheStreamNothingIsInAHurry) {
  BackendRun live(RoundJoiner::Mode::kLive);
  for (const Sent& sent : upstreamOf(10, kLiveStages)) {
    EXPECT_FALSE(live.node.inputEnded());
    live.play(sent);
    if (sent.channel != "ODOMETRY_END") live.answerAll();
  }
  EXPECT_TRUE(live.node.inputEnded());
  EXPECT_FALSE(live.node.done());
  EXPECT_EQ(live.node.awaitedRound(), 4) << "the answer to the first final round";
  live.answerAll();
  EXPECT_TRUE(live.node.done());
}

TEST(LiveRoundsTest, AStageThatNeverAnswersHoldsNothingAndTheRunReplays) {
  BackendRun live(RoundJoiner::Mode::kLive);
  for (const Sent& sent : upstreamOf(12, kLiveStages)) {
    live.play(sent);
    if (live.node.awaitedRound() >= 0) live.node.leaveOutAwaited();
  }
  for (int i = 0; i < 10 && !live.node.done(); ++i) live.node.giveUpAwaited();
  ASSERT_TRUE(live.node.done());
  EXPECT_GE(live.core->inputs.size(), 4u);
  EXPECT_EQ(live.node.result().reproducible, 0) << "the final rounds had all the time, and got no answer";
}

// A late plane says something of its own keyframe, not of a later one: rounds wait for planes, unless their
// process is gone for good.
TEST(LiveRoundsTest, PlanesHaveNoDeadlineButAreGivenUpWhenTheirProcessIsGone) {
  BackendRun live(RoundJoiner::Mode::kLive);
  const std::vector<Sent> stream = upstreamOf(7, {"odometry", "planes", "backend"});
  live.play({stream.begin(), stream.end() - 1});
  EXPECT_EQ(live.core->inputs.size(), 0u);
  EXPECT_EQ(live.node.awaitedPlanes(), 0);
  live.node.leaveOutAwaited();
  EXPECT_EQ(live.core->inputs.size(), 0u);
  live.node.giveUpPlanes();
  EXPECT_EQ(live.core->inputs.size(), 1u);
  EXPECT_EQ(live.node.awaitedPlanes(), 1);
}

TEST(LiveRoundsTest, StatusTellsHowManyAnswersWereLate) {
  BackendRun live(RoundJoiner::Mode::kLive);
  Recorder<status_t> status(live.bus, channels::kStatusBackend);
  liveWalk(live);
  live.node.publishStatus();
  live.bus.dispatch(0);
  EXPECT_EQ(status.messages.at(0).state, "done, 8 answers joined later");
}

}  // namespace
}  // namespace sgraphs
