#include "backend/backend_node.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "perception/planes/planes_node.h"
#include "tests/tools/system/bus_recorder.h"
#include "tests/tools/system/fake_cores.h"

namespace sgraphs {
namespace {

using testing::FakeBackend;
using testing::FakeOdometry;
using testing::Recorder;
using testing::Source;

// One message that the odometry process would send.
struct Sent {
  std::string channel;
  std::vector<uint8_t> bytes;
};

// What sgraphs-odometry sends for `scans` scans at these times, SESSION of the source first.
std::vector<Sent> odometryStream(int scans, double step_s = 0.1, size_t points = 20,
                                 const std::string& why_not = "") {
  MemoryBus bus;
  std::vector<Sent> sent;
  for (const char* channel : {"SESSION", "ODOMETRY", "KEYFRAME", "ODOMETRY_END"})
    bus.subscribe(channel, [&sent, channel](Bus::Bytes b) {
      sent.push_back({channel, {b.begin(), b.end()}});
    });
  OdometryNode node(bus, partsOf(std::make_shared<FakeOdometry>(3, points)));
  Source source(bus);
  source.session("lidar", false, {"odometry", "backend"});
  for (int s = 0; s < scans; ++s) source.packet(step_s * s);
  source.end(why_not);
  return sent;
}

// The same with sgraphs-planes taking part, which sees one plane, farther away by one metre per keyframe.
std::vector<Sent> streamWithPlanes(int scans) {
  MemoryBus bus;
  std::vector<Sent> sent;
  for (const char* channel :
       {"SESSION", "ODOMETRY", "KEYFRAME", "ODOMETRY_END", "KEYFRAME_PLANES", "PLANES_END"})
    bus.subscribe(channel, [&sent, channel](Bus::Bytes b) {
      sent.push_back({channel, {b.begin(), b.end()}});
    });
  OdometryNode odometry(bus, partsOf(std::make_shared<FakeOdometry>(3, 20)));
  PlanesNode planes(bus, [](const Keyframe& keyframe) {
    KeyframePlanes seen;
    seen.keyframe = keyframe.id;
    seen.time = keyframe.time;
    PlaneObservation& z = seen.planes.emplace_back();
    z.centroid_body = {0, 0, -1.0 - static_cast<double>(keyframe.id.value)};
    z.num_points = 1;
    z.boundary = {{0, 0}, {1, 0}, {0, 1}};
    return seen;
  });
  Source source(bus);
  source.session("lidar", false, {"odometry", "planes", "backend"});
  for (int s = 0; s < scans; ++s) source.packet(0.1 * s);
  source.end();
  return sent;
}

class BackendNodeTest : public ::testing::Test {
 protected:
  void play(const std::vector<Sent>& stream) {
    for (const Sent& sent : stream) {
      bus.publish(sent.channel, sent.bytes);
      bus.dispatch(0);
    }
  }
  // Drops the n-th message (from 0) of a channel.
  static void drop(std::vector<Sent>& stream, const std::string& channel, int n) {
    const auto found = std::find_if(stream.begin(), stream.end(),
                                    [&](const Sent& s) { return s.channel == channel && n-- == 0; });
    ASSERT_NE(found, stream.end());
    stream.erase(found);
  }
  std::string digestOf(const std::vector<Sent>& stream) {
    MemoryBus own;
    BackendNode other(own, coreOf(std::make_shared<FakeBackend>()));
    for (const Sent& sent : stream) {
      own.publish(sent.channel, sent.bytes);
      own.dispatch(0);
    }
    EXPECT_TRUE(other.done());
    return other.result().graph_digest;
  }

  MemoryBus bus;
  std::shared_ptr<FakeBackend> core = std::make_shared<FakeBackend>();
  Recorder<graph_update_t> updates{bus, channels::kGraphUpdate};
  Recorder<graph_update_t> snapshots{bus, channels::kGraphSnapshot};
  Recorder<pose_t> poses{bus, channels::kPose};
  Recorder<map_to_odom_t> map_to_odom{bus, channels::kMapToOdom};
  Recorder<run_result_t> results{bus, channels::kRunResult};
  BackendNode node{bus, coreOf(core)};
};

TEST_F(BackendNodeTest, ARoundPerKeyframeThenFinalRoundsThenTheResult) {
  play(odometryStream(7));
  ASSERT_TRUE(node.done());
  EXPECT_EQ(core->inputs.size(), 4u);  // keyframes 0, 1, 2 and one idle round that changed nothing
  EXPECT_EQ(node.scans().size(), 7u);
  ASSERT_EQ(results.messages.size(), 1u);
  const run_result_t& result = results.messages[0];
  EXPECT_EQ(result.reproducible, 1);
  EXPECT_EQ(result.why_not, "");
  EXPECT_EQ(result.rounds, 4);
  EXPECT_EQ(result.graph_digest, updates.messages.back().graph_digest);
  EXPECT_EQ(map_to_odom.messages.size(), 4u);
  ASSERT_EQ(snapshots.messages.size(), 1u);
  EXPECT_EQ(snapshots.messages[0].complete, 1);
  EXPECT_EQ(snapshots.messages[0].num_nodes, 3);
}

TEST_F(BackendNodeTest, PoseUsesTheRoundOfTheNewestKeyframeAtOrBeforeItsScan) {
  play(odometryStream(7));
  ASSERT_EQ(poses.messages.size(), 7u);
  for (int s = 0; s < 7; ++s) {
    const int round = s / 3;
    EXPECT_NEAR(poses.messages[s].pos[0], 0.1 * s, 1e-12);
    EXPECT_DOUBLE_EQ(poses.messages[s].pos[2], 1.0 + round);  // the fake lifts by 1 + round
  }
}

TEST_F(BackendNodeTest, TheOrderInWhichProcessesAreHeardDoesNotMatter) {
  const std::vector<Sent> stream = odometryStream(20, 0.1, 15000);
  // KEYFRAME far ahead of ODOMETRY, and SESSION last but for the end: each channel keeps its own order.
  std::vector<Sent> keyframes_first;
  for (const char* channel : {"KEYFRAME", "ODOMETRY", "SESSION", "ODOMETRY_END"})
    for (const Sent& sent : stream)
      if (sent.channel == channel) keyframes_first.push_back(sent);
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(digestOf(keyframes_first), node.result().graph_digest);
}

// Datagrams overtake each other: a keyframe is waited for until two more scans have come.
TEST_F(BackendNodeTest, AKeyframeMayBeOvertakenByTheNextScan) {
  const std::vector<Sent> stream = odometryStream(20);
  std::vector<Sent> overtaken = stream;
  int swapped = 0;
  for (size_t i = 0; i + 1 < overtaken.size(); ++i)
    if (overtaken[i].channel == "KEYFRAME" && overtaken[i + 1].channel == "ODOMETRY") {
      std::swap(overtaken[i], overtaken[i + 1]);
      ++swapped;
      ++i;
    }
  ASSERT_GE(swapped, 6);
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(digestOf(overtaken), node.result().graph_digest);
}

TEST_F(BackendNodeTest, ALostChunkLeavesTheKeyframeWithTheRestOfItsPoints) {
  std::vector<Sent> stream = odometryStream(7, 0.1, 15000);
  drop(stream, "KEYFRAME", 4);  // the second of three chunks of keyframe 1
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().reproducible, 0);
  EXPECT_NE(node.result().why_not.find("1 message(s) of KEYFRAME lost"), std::string::npos);
  ASSERT_GE(core->inputs.size(), 3u);
  EXPECT_EQ(core->inputs[1].keyframe->id.value, 1);
  EXPECT_EQ(core->inputs[1].keyframe->points.size(), 9000u);
  EXPECT_EQ(core->inputs[2].keyframe->points.size(), 15000u);
}

TEST_F(BackendNodeTest, AKeyframeLostAsAWholeIsStoodInForByOdometry) {
  std::vector<Sent> stream = odometryStream(10);
  drop(stream, "KEYFRAME", 1);
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().reproducible, 0);
  ASSERT_EQ(node.graph().keyframes.size(), 4u);
  const Keyframe& stand_in = *node.graph().keyframes.at(KeyframeId{1}).keyframe;
  EXPECT_TRUE(stand_in.points.empty());
  EXPECT_NEAR(stand_in.T_odom_body.translation.x(), 0.3, 1e-12);
  EXPECT_EQ(stand_in.scan, 3);
  EXPECT_EQ(poses.messages.size(), 10u);
}

TEST_F(BackendNodeTest, TheLastKeyframesLossIsFoundAtTheEnd) {
  std::vector<Sent> stream = odometryStream(7);
  drop(stream, "KEYFRAME", 2);
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().reproducible, 0);
  EXPECT_EQ(node.graph().keyframes.size(), 3u);
}

TEST_F(BackendNodeTest, LostOdometryOfAKeyframesScanStillGivesItsRound) {
  std::vector<Sent> stream = odometryStream(10);
  drop(stream, "ODOMETRY", 3);
  drop(stream, "ODOMETRY", 8);  // scan 9: the last, keyframe 3
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.graph().keyframes.size(), 4u);
  EXPECT_EQ(node.result().why_not, "2 message(s) of ODOMETRY lost");
  EXPECT_EQ(node.scans().size(), 8u);
}

TEST_F(BackendNodeTest, AKeyframeOfWhichNothingCameIsPassedOver) {
  std::vector<Sent> stream = odometryStream(10);
  drop(stream, "ODOMETRY", 3);
  drop(stream, "KEYFRAME", 1);
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_FALSE(node.graph().keyframes.contains(KeyframeId{1}));
  EXPECT_TRUE(node.graph().keyframes.contains(KeyframeId{2}));
  EXPECT_EQ(node.result().rounds, 4);  // keyframes 0, 2, 3 and the final round
}

TEST_F(BackendNodeTest, EverySecondMessageLostStillEndsWithTheReason) {
  std::vector<Sent> stream = odometryStream(30, 0.1, 15000), thinned;
  for (size_t i = 0; i < stream.size(); ++i)
    if (i % 2 == 0 || stream[i].channel == "ODOMETRY_END") thinned.push_back(stream[i]);
  play(thinned);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().reproducible, 0);
}

TEST_F(BackendNodeTest, AnIdleRoundRunsAfterFiveSecondsOfSensorTimeWithoutAKeyframe) {
  play(odometryStream(6, 2.0));  // keyframes at 0 and 6 s; scans every 2 s
  ASSERT_TRUE(node.done());
  EXPECT_EQ(core->idle_rounds, 1);  // the final one only
  MemoryBus other_bus;
  auto other_core = std::make_shared<FakeBackend>();
  BackendNode other(other_bus, coreOf(other_core));
  for (const Sent& sent : odometryStream(6, 3.0)) {
    other_bus.publish(sent.channel, sent.bytes);
    other_bus.dispatch(0);
  }
  // Scans at 0, 3, 6, 9 (keyframe), 12, 15 s: idle at 6 and 15, and the final one.
  EXPECT_EQ(other_core->idle_rounds, 3);
  EXPECT_EQ(other_core->inputs[1].time.us - other_core->inputs[0].time.us, 6'000'000);
}

TEST_F(BackendNodeTest, FinalRoundsStopAfterFive) {
  MemoryBus other_bus;
  auto busy = std::make_shared<FakeBackend>(1000);
  BackendNode other(other_bus, coreOf(busy));
  for (const Sent& sent : odometryStream(2)) {
    other_bus.publish(sent.channel, sent.bytes);
    other_bus.dispatch(0);
  }
  EXPECT_TRUE(other.done());
  EXPECT_EQ(busy->idle_rounds, BackendNode::kMaxFinalRounds);
}

// The end of an earlier session of a map: what it ended with is done again, and the run goes on.
TEST_F(BackendNodeTest, AtRestItIsWhereARunEndsAndGoesOn) {
  std::vector<Sent> stream = odometryStream(7);
  const std::string at_end = digestOf(stream);
  const Sent end = stream.back();
  ASSERT_EQ(end.channel, "ODOMETRY_END");
  std::vector<Sent> first(stream.begin(), stream.end() - 1);
  const auto later =
      std::find_if(first.rbegin(), first.rend(), [](const Sent& s) { return s.channel == "KEYFRAME"; });
  const std::vector<Sent> rest(later.base() - 1, first.end());
  first.erase(later.base() - 1, first.end());
  play(first);
  node.rest();
  EXPECT_FALSE(node.resting());
  EXPECT_FALSE(node.done());
  EXPECT_EQ(core->idle_rounds, 1);
  play(rest);
  EXPECT_EQ(core->inputs.size(), 4u) << "keyframes 0 and 1, an idle round, keyframe 2";
  play({end});
  EXPECT_TRUE(node.done());
  EXPECT_EQ(core->idle_rounds, 2);

  MemoryBus other_bus;
  BackendNode other(other_bus, coreOf(std::make_shared<FakeBackend>()));
  for (size_t i = 0; i + 1 < stream.size(); ++i) {
    other_bus.publish(stream[i].channel, stream[i].bytes);
    other_bus.dispatch(0);
  }
  other.rest();
  EXPECT_EQ(other.graphDigest(), at_end);
}

TEST_F(BackendNodeTest, TheReasonOfTheOdometryIsHandedOn) {
  play(odometryStream(4, 0.1, 20, "1 message(s) of SPOT_ODOMETRY lost"));
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().why_not, "1 message(s) of SPOT_ODOMETRY lost");
}

TEST_F(BackendNodeTest, DerivedMessagesOfAnotherSessionAreRefusedEvenBeforeSession) {
  std::vector<Sent> stream = odometryStream(7);
  odometry_t foreign{};
  foreign.header.session = 99;
  foreign.T_odom_body.wxyz[0] = 1;
  for (int i = 0; i < 6; ++i) foreign.covariance[static_cast<size_t>(7 * i)] = 1;
  publish(bus, channels::kOdometry, foreign);
  bus.dispatch(0);
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.graph().keyframes.size(), 3u);
  EXPECT_NE(node.result().why_not.find("refused (of another session)"), std::string::npos);
}

TEST_F(BackendNodeTest, IdsThatCannotBeAreRefused) {
  std::vector<Sent> stream = odometryStream(8);
  const Sent end = stream.back();
  stream.pop_back();
  play(stream);
  odometry_t jump{};
  ASSERT_TRUE(decode(stream.back().bytes, jump));
  jump.header.seq += 1;
  jump.header.utime += 100'000;
  jump.scan += 1;
  jump.keyframe = int64_t{1} << 60;
  publish(bus, channels::kOdometry, jump);
  bus.dispatch(0);
  EXPECT_EQ(node.gate().counts().at("ODOMETRY").rejected, 1);
  play({end});
  EXPECT_TRUE(node.done());
  EXPECT_EQ(node.graph().keyframes.size(), 3u);
}

TEST_F(BackendNodeTest, WithoutAnEndTheLastCompleteRoundCounts) {
  std::vector<Sent> stream = odometryStream(7);
  stream.pop_back();
  play(stream);
  EXPECT_FALSE(node.done());
  node.finish("");
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().reproducible, 1);
  EXPECT_EQ(node.result().graph_digest, digestOf(odometryStream(7)));
}

TEST_F(BackendNodeTest, WithoutAnyMessageItEndsAllTheSame) {
  node.finish("");
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().why_not, "no SESSION arrived");
  EXPECT_EQ(node.result().rounds, 0);
}

TEST_F(BackendNodeTest, ALiveRunRecordsWhatJoinedAndAPlaybackObeysIt) {
  MemoryBus live_bus;
  BackendNode live(live_bus, coreOf(std::make_shared<FakeBackend>()), RoundJoiner::Mode::kLive);
  Recorder<round_schedule_t> schedules(live_bus, channels::kRoundSchedule);
  const std::vector<Sent> stream = odometryStream(7, 0.1, 15000);
  for (const Sent& sent : stream) {
    live_bus.publish(sent.channel, sent.bytes);
    live_bus.dispatch(0);
  }
  ASSERT_EQ(schedules.messages.size(), 4u);
  EXPECT_EQ(schedules.messages[1].seq, std::vector<int64_t>{5});  // last of three chunks each
  play({stream.front()});
  for (const round_schedule_t& m : schedules.messages) publish(bus, channels::kRoundSchedule, m);
  bus.dispatch(0);
  play({stream.begin() + 1, stream.end()});
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().graph_digest, live.result().graph_digest);
  EXPECT_EQ(node.result().reproducible, 1);
}

TEST_F(BackendNodeTest, ALongRunSendsASnapshotEveryFiftyRounds) {
  play(odometryStream(3 * 120));
  ASSERT_TRUE(node.done());
  EXPECT_EQ(snapshots.messages.size(), 3u);  // after 50, after 100, at the end
}

// Each round's own planes, however far behind the segmentation is.
TEST_F(BackendNodeTest, ARoundWaitsForItsPlanes) {
  std::vector<Sent> stream = streamWithPlanes(7);
  std::stable_partition(stream.begin(), stream.end(),
                        [](const Sent& s) { return s.channel.find("PLANES") == std::string::npos; });
  const auto planes = std::find_if(stream.begin(), stream.end(),
                                   [](const Sent& s) { return s.channel == "KEYFRAME_PLANES"; });
  play({stream.begin(), planes});
  EXPECT_TRUE(core->inputs.empty());
  EXPECT_FALSE(node.done()) << "the odometry has ended, the planes have not";
  play({planes, stream.end()});
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().why_not, "");
  ASSERT_EQ(core->inputs.size(), 4u);
  for (int64_t k = 0; k < 3; ++k) {
    const auto& seen = core->inputs[static_cast<size_t>(k)].planes;
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->keyframe.value, k);
    EXPECT_DOUBLE_EQ(seen->planes.at(0).d(), 1.0 + static_cast<double>(k));
  }
}

TEST_F(BackendNodeTest, LostPlanesAreGoneOnWithoutAndNamed) {
  std::vector<Sent> stream = streamWithPlanes(13);
  drop(stream, "KEYFRAME_PLANES", 1);
  play(stream);
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().reproducible, 0);
  EXPECT_NE(node.result().why_not.find("KEYFRAME_PLANES"), std::string::npos) << node.result().why_not;
  ASSERT_EQ(core->inputs.size(), 6u);
  EXPECT_TRUE(core->inputs[0].planes);
  EXPECT_FALSE(core->inputs[1].planes);
  EXPECT_TRUE(core->inputs[2].planes);
}

TEST_F(BackendNodeTest, WithoutPlanesEndTheRunEndsAllTheSame) {
  std::vector<Sent> stream = streamWithPlanes(7);
  drop(stream, "PLANES_END", 0);
  play(stream);
  EXPECT_FALSE(node.done());
  node.finish("the end of the stream did not arrive within 30 s");
  ASSERT_TRUE(node.done());
  EXPECT_EQ(node.result().reproducible, 0);
  EXPECT_EQ(core->inputs.size(), 4u);
}

TEST_F(BackendNodeTest, PlanesThatCannotBeAreRefused) {
  std::vector<Sent> stream = streamWithPlanes(7);
  play({stream.front()});
  keyframe_planes_t m{};
  m.header.session = 7;
  m.keyframe = 1'000'000;
  publish(bus, channels::kKeyframePlanes, m);
  m.header.seq = 1;
  m.keyframe = 0;
  m.num_planes = 1;
  m.planes.resize(1);  // no normal, no boundary
  publish(bus, channels::kKeyframePlanes, m);
  bus.dispatch(0);
  EXPECT_NE(node.gate().trouble().find("KEYFRAME_PLANES"), std::string::npos) << node.gate().trouble();
}

}  // namespace
}  // namespace sgraphs
