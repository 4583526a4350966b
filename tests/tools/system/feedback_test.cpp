// The loop from the backend through free space, rooms and loops back to it, with small cores.
#include <gtest/gtest.h>

#include "backend/backend_node.h"
#include "lcmtypes/convert/convert_layers.h"
#include "perception/free_space/free_space_node.h"
#include "perception/loops/loops_node.h"
#include "perception/rooms/rooms_node.h"
#include "tests/tools/system/bus_recorder.h"
#include "tests/tools/system/fake_cores.h"

namespace sgraphs {
namespace {

using testing::FakeBackend;
using testing::FakeOdometry;
using testing::kWithoutLoops;
using testing::Recorder;
using testing::Source;

const std::vector<std::string> kStages = {"odometry", "free-space", "rooms", "loops", "backend"};

// One vertex per keyframe whose cloud came.
class FakeFreeSpace {
 public:
  const FreeSpace& step(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
    space_.round = update.round;
    space_.time = update.time;
    if (keyframe) {
      const VertexId id{keyframe->id.value};
      space_.vertices[id] = {id, FloorId{0}, ClusterId{0}, {0, 0, 0}, 1, {}};
    }
    return space_;
  }

 private:
  FreeSpace space_;
};

// A floor whose height counts the vertices.
Rooms roomsOf(const FreeSpace& space, const MapUpdate& update) {
  return {.round = update.round,
          .time = update.time,
          .rooms = {},
          .doorways = {},
          .floors = {{FloorId{0}, true, static_cast<double>(space.vertices.size()), {0, 0}}},
          .keyframe_floors = {}};
}

// A loop to the first keyframe from each later cloud, found one round late; the search then takes a round
// more.
class FakeLoops {
 public:
  LoopClosures step(const std::optional<Keyframe>& keyframe, const MapUpdate& update) {
    LoopClosures loops;
    loops.round = update.round;
    loops.time = update.time;
    if (const auto found = std::exchange(found_, std::nullopt)) {
      LoopClosure loop;
      loop.id = LoopId{found->value};
      loop.pose.kind = RelativePoseKind::kLoop;
      loop.pose.from = KeyframeId{0};
      loop.pose.to = *found;
      loops.accepted.push_back(loop);
      loops.searching = true;
    }
    if (keyframe && keyframe->id.value > 0) found_ = keyframe->id;
    loops.searching = loops.searching || found_;
    return loops;
  }

 private:
  std::optional<KeyframeId> found_;
};

class FeedbackTest : public ::testing::Test {
 protected:
  void walk(int scans, const std::vector<std::string>& stages) {
    source.session("lidar", false, stages);
    for (int s = 0; s < scans; ++s) source.packet(0.1 * s);
    source.end();
  }
  std::shared_ptr<FakeFreeSpace> free_space_core = std::make_shared<FakeFreeSpace>();
  std::shared_ptr<FakeBackend> backend_core = std::make_shared<FakeBackend>();
  MemoryBus bus;
  Recorder<free_space_t> free_space_messages{bus, channels::kFreeSpace};
  Recorder<rooms_t> rooms_messages{bus, channels::kRooms};
  OdometryNode odometry{bus, testing::partsOf(std::make_shared<FakeOdometry>())};
  FreeSpaceNode free_space{bus, [this](const auto& keyframe, const auto& update) -> const FreeSpace& {
                             return free_space_core->step(keyframe, update);
                           }};
  RoomsNode rooms{bus, roomsOf};
  std::shared_ptr<FakeLoops> loops_core = std::make_shared<FakeLoops>();
  LoopsNode loops{
      bus, [this](const auto& keyframe, const auto& update) { return loops_core->step(keyframe, update); }};
  BackendNode backend{bus, coreOf(backend_core)};
  Source source{bus};
};

TEST_F(FeedbackTest, EachRoundJoinsWhatWasMadeOfTheRoundBefore) {
  walk(10, kWithoutLoops);  // keyframes 0 to 3
  ASSERT_TRUE(backend.done());
  const auto& inputs = backend_core->inputs;
  ASSERT_EQ(inputs.size(), 4u + BackendNode::kQuietRounds);
  EXPECT_FALSE(inputs[0].rooms);
  EXPECT_FALSE(inputs[0].free_space);
  for (size_t round = 1; round < inputs.size(); ++round) {
    ASSERT_TRUE(inputs[round].rooms) << round;
    EXPECT_EQ(inputs[round].rooms->round, static_cast<int64_t>(round) - 1);
    EXPECT_EQ(inputs[round].free_space->round, static_cast<int64_t>(round) - 1);
    const double keyframes = static_cast<double>(std::min<size_t>(round, 4));
    EXPECT_EQ(inputs[round].rooms->floors.at(0).z_m, keyframes) << "as many clouds as there were keyframes";
  }
  EXPECT_EQ(backend.result().why_not, "");
  EXPECT_EQ(free_space_messages.messages.size(), inputs.size()) << "one answer per round";
  EXPECT_EQ(rooms_messages.messages.size(), inputs.size() - 1) << "RUN_RESULT comes before the last";
  EXPECT_TRUE(free_space.done());
  EXPECT_TRUE(rooms.done());
}

TEST_F(FeedbackTest, LoopsJoinTheNextRoundAndTheEndWaitsForTheSearch) {
  walk(10, kStages);  // keyframes 0 to 3; that of the last is found in the first final round
  ASSERT_TRUE(backend.done());
  EXPECT_EQ(backend.result().why_not, "");
  const auto& inputs = backend_core->inputs;
  std::vector<int64_t> found_from, joined_round;
  for (size_t round = 0; round < inputs.size(); ++round) {
    ASSERT_EQ(inputs[round].loops.has_value(), round > 0);
    if (round == 0) continue;
    EXPECT_EQ(inputs[round].loops->round, static_cast<int64_t>(round) - 1);
    for (const LoopClosure& loop : inputs[round].loops->accepted) {
      found_from.push_back(loop.pose.to.value);
      joined_round.push_back(static_cast<int64_t>(round));
    }
  }
  EXPECT_EQ(found_from, (std::vector<int64_t>{1, 2, 3}));
  EXPECT_EQ(joined_round, (std::vector<int64_t>{3, 4, 5}));
  EXPECT_EQ(inputs.size(), 8u) << "rounds 4 and 5 end with a search going on, 6 and 7 are quiet";
  EXPECT_TRUE(loops.done());
}

TEST_F(FeedbackTest, WithoutTheStagesNothingIsWaitedForAndNothingSaid) {
  source.session("lidar", false, {"odometry", "backend"});
  for (int s = 0; s < 10; ++s) source.packet(0.1 * s);
  source.end();
  ASSERT_TRUE(backend.done());
  EXPECT_EQ(backend_core->inputs.size(), 5u);
  EXPECT_TRUE(free_space_messages.messages.empty());
  EXPECT_TRUE(rooms_messages.messages.empty());
  EXPECT_TRUE(rooms.done()) << "RUN_RESULT ends it";
}

// A stage that is silent in one round: what it would have said is lost.
class LossyFeedbackTest : public ::testing::Test {
 protected:
  LossyFeedbackTest() {
    Source source(upstream_bus);
    for (const char* channel : {"SESSION", "ODOMETRY", "KEYFRAME", "ODOMETRY_END"})
      upstream_bus.subscribe(channel, [this, channel](Bus::Bytes b) {
        upstream.emplace_back(channel, std::vector<uint8_t>(b.begin(), b.end()));
      });
    OdometryNode odometry(upstream_bus, testing::partsOf(std::make_shared<FakeOdometry>()));
    source.session("lidar", false, kStages);
    for (int s = 0; s < 10; ++s) source.packet(0.1 * s);
    source.end();
  }
  void play() {
    for (const auto& [channel, bytes] : upstream) {
      bus.publish(channel, bytes);
      bus.dispatch(0);
    }
  }
  void answer(int64_t round) {
    const auto say = [&](const auto& channel, auto m) {
      m.header.session = 7;
      m.header.seq = m.round = round;
      m.num_chunks = 1;
      publish(bus, channel, m);
    };
    say(channels::kRooms, rooms_t{});
    say(channels::kFreeSpace, free_space_t{});
    say(channels::kLoopClosures, loop_closures_t{});
    bus.dispatch(0);
  }
  MemoryBus upstream_bus, bus;
  std::vector<std::pair<std::string, std::vector<uint8_t>>> upstream;
  std::shared_ptr<FakeBackend> core = std::make_shared<FakeBackend>();
  BackendNode backend{bus, coreOf(core)};
};

TEST_F(LossyFeedbackTest, ARoundWaitsForItsAnswersUntilTheyAreGivenUp) {
  play();
  EXPECT_EQ(core->inputs.size(), 1u);
  EXPECT_EQ(backend.awaitedRound(), 0);
  answer(0);
  EXPECT_EQ(core->inputs.size(), 2u);
  EXPECT_EQ(backend.awaitedRound(), 1);
  backend.giveUpAwaited();  // both answers to round 1 were lost
  EXPECT_EQ(core->inputs.size(), 3u);
  EXPECT_FALSE(core->inputs[2].rooms);
  EXPECT_EQ(core->inputs[2].free_space->round, 0) << "the newest that is known";
  for (int64_t round = 2; !backend.done() && round < 20; ++round) answer(round);
  ASSERT_TRUE(backend.done());
  EXPECT_EQ(backend.awaitedRound(), -1);
  EXPECT_EQ(backend.result().reproducible, 0);
  EXPECT_EQ(
      backend.result().why_not,
      "1 message(s) of FREE_SPACE lost; 1 message(s) of LOOP_CLOSURES lost; 1 message(s) of ROOMS lost; "
      "1 FREE_SPACE incomplete when their round ran; 1 LOOP_CLOSURES incomplete when their round ran; "
      "1 ROOMS incomplete when their round ran");
}

TEST_F(LossyFeedbackTest, AForcedEndWaitsForNothing) {
  play();
  backend.finish("stopped by a signal");
  ASSERT_TRUE(backend.done());
  EXPECT_GE(core->inputs.size(), 5u) << "every keyframe had its round";
  EXPECT_EQ(backend.result().why_not, "stopped by a signal");
}

TEST_F(LossyFeedbackTest, AnAnswerToARoundThatHasNotRunIsRefused) {
  play();
  answer(5);
  EXPECT_EQ(backend.gate().counts().at("ROOMS").rejected, 1);
  EXPECT_EQ(backend.gate().counts().at("FREE_SPACE").rejected, 1);
  EXPECT_EQ(core->inputs.size(), 1u);
}

TEST_F(LossyFeedbackTest, AnAnswerWhoseContentCannotBeIsLost) {
  play();
  rooms_t m{};
  m.header.session = 7;
  m.num_chunks = 1;
  m.floors.resize(1);
  m.floors[0].id = -1;
  m.num_floors = 1;
  publish(bus, channels::kRooms, m);
  free_space_t f{};
  f.header.session = 7;
  f.num_chunks = 1;
  publish(bus, channels::kFreeSpace, f);
  loop_closures_t l{};
  l.header.session = 7;
  l.num_chunks = 1;
  l.accepted.resize(1);
  l.num_accepted = 1;  // a quaternion of zeros
  publish(bus, channels::kLoopClosures, l);
  bus.dispatch(0);
  EXPECT_EQ(core->inputs.size(), 2u) << "the round goes on without";
  EXPECT_FALSE(core->inputs[1].rooms);
  EXPECT_FALSE(core->inputs[1].loops);
  EXPECT_EQ(backend.gate().counts().at("ROOMS").rejected, 1);
  EXPECT_EQ(backend.gate().counts().at("LOOP_CLOSURES").rejected, 1);
}

}  // namespace
}  // namespace sgraphs
