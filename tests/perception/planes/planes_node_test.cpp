#include "perception/planes/planes_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/tools/system/bus_recorder.h"

namespace sgraphs {
namespace {

using testing::Recorder;
using testing::Source;

// One plane whose number of points is that of the keyframe: what was segmented shows in the output.
KeyframePlanes countPoints(const Keyframe& keyframe) {
  KeyframePlanes planes{keyframe.id, keyframe.time, {}};
  PlaneObservation plane;
  plane.centroid_body = {0, 0, -1};
  plane.num_points = static_cast<int>(keyframe.points.size());
  plane.boundary = {{0, 0}, {1, 0}, {0, 1}};
  planes.planes = {plane};
  return planes;
}

class PlanesNodeTest : public ::testing::Test {
 protected:
  // Three chunks of 6000, 6000 and 3000 points.
  static std::vector<keyframe_t> chunksOf(int64_t id, size_t points = 15000) {
    Keyframe keyframe;
    keyframe.id = KeyframeId{id};
    keyframe.time = Source::at(1.0 + static_cast<double>(id));
    keyframe.T_keyframe_body = {SE3()};
    keyframe.points.assign(points, {{1, 2, 3}, 0, 1});
    return toMessages(keyframe);
  }
  void sendKeyframe(int64_t id) {
    for (const keyframe_t& chunk : chunksOf(id)) source.send(channels::kKeyframe, chunk);
  }
  // As the odometry ends its stream, with the number of the last chunk sent.
  void odometryEnds(int64_t last_seq, const std::string& why_not = "") {
    stream_end_t m{};
    m.header.utime = Source::at(100).us;
    m.why_not = why_not;
    m.channel = {"ODOMETRY", "KEYFRAME"};
    m.last_seq = {100, last_seq};
    m.num_channels = 2;
    source.send(channels::kOdometryEnd, m);
  }
  std::vector<int64_t> ids() const {
    std::vector<int64_t> all;
    for (const keyframe_planes_t& m : planes.messages) all.push_back(m.keyframe);
    return all;
  }
  int pointsOf(size_t message) const { return planes.messages.at(message).planes.at(0).num_points; }
  int64_t refused() const { return node.gate().counts().at("KEYFRAME").rejected; }

  MemoryBus bus;
  Recorder<keyframe_planes_t> planes{bus, channels::kKeyframePlanes};
  Recorder<stream_end_t> ends{bus, channels::kPlanesEnd};
  PlanesNode node{bus, countPoints};
  Source source{bus};
};

TEST_F(PlanesNodeTest, PublishesOneMessagePerKeyframeInOrderAndTheEnd) {
  source.session("lidar", false);
  for (int64_t k = 0; k < 4; ++k) sendKeyframe(k);
  EXPECT_EQ(ids(), (std::vector<int64_t>{0, 1, 2, 3}));
  EXPECT_EQ(pointsOf(3), 15000);
  EXPECT_EQ(planes.messages[3].header.seq, 3);
  EXPECT_EQ(planes.messages[3].header.session, 7);
  EXPECT_EQ(planes.messages[3].header.utime, Source::at(4).us);
  EXPECT_FALSE(node.done());
  odometryEnds(11);
  ASSERT_TRUE(node.done());
  ASSERT_EQ(ends.messages.size(), 1u);
  EXPECT_EQ(ends.messages[0].channel, std::vector<std::string>{"KEYFRAME_PLANES"});
  EXPECT_EQ(ends.messages[0].last_seq, std::vector<int64_t>{3});
  EXPECT_EQ(ends.messages[0].why_not, "");
  EXPECT_EQ(ends.messages[0].header.utime, Source::at(100).us);
}

TEST_F(PlanesNodeTest, ChunksInAnyOrderMakeTheKeyframe) {
  source.session("lidar", false);
  const auto chunks = chunksOf(0);
  for (const size_t i : {2u, 0u, 1u}) {
    EXPECT_TRUE(planes.messages.empty());
    source.send(channels::kKeyframe, chunks[i]);
  }
  ASSERT_EQ(ids(), std::vector<int64_t>{0});
  EXPECT_EQ(pointsOf(0), 15000);
}

TEST_F(PlanesNodeTest, AKeyframeThatLostAChunkIsWorkedOffWhenALaterOneIsHeard) {
  source.session("lidar", false);
  sendKeyframe(0);
  source.loseNext("KEYFRAME");
  sendKeyframe(1);
  EXPECT_EQ(ids(), std::vector<int64_t>{0});
  source.send(channels::kKeyframe, chunksOf(2)[0]);
  EXPECT_EQ(ids(), (std::vector<int64_t>{0, 1}));
  EXPECT_EQ(pointsOf(1), 9000);
  source.send(channels::kKeyframe, chunksOf(2)[1]);
  source.loseNext("KEYFRAME");
  source.send(channels::kKeyframe, chunksOf(2)[2]);
  odometryEnds(8);
  EXPECT_EQ(ids(), (std::vector<int64_t>{0, 1, 2})) << "the end is heard";
  EXPECT_EQ(pointsOf(2), 12000);
  EXPECT_EQ(ends.messages.at(0).why_not, "2 message(s) of KEYFRAME lost");
}

TEST_F(PlanesNodeTest, AKeyframeOfWhichNothingCameIsLeftOut) {
  source.session("lidar", false);
  sendKeyframe(0);
  for (const keyframe_t& chunk : chunksOf(1)) {
    source.loseNext("KEYFRAME");
    source.send(channels::kKeyframe, chunk);
  }
  sendKeyframe(2);
  EXPECT_EQ(ids(), (std::vector<int64_t>{0, 2}));
  EXPECT_EQ(planes.messages[1].header.seq, 1);
}

TEST_F(PlanesNodeTest, WhatComesBeforeSessionWaitsForIt) {
  sendKeyframe(0);
  EXPECT_TRUE(planes.messages.empty());
  source.session("lidar", false);
  bus.dispatch(0);
  EXPECT_EQ(ids(), std::vector<int64_t>{0});
}

TEST_F(PlanesNodeTest, ASessionWithoutTheStageHasOnlyAnEnd) {
  source.session("lidar", false, {"odometry", "backend"});
  sendKeyframe(0);
  odometryEnds(2);
  EXPECT_TRUE(planes.messages.empty());
  EXPECT_TRUE(node.done());
  EXPECT_EQ(ends.messages.size(), 1u);
  EXPECT_EQ(node.whyNot(), "");
}

TEST_F(PlanesNodeTest, ASessionThatListsTheStageHasPlanes) {
  source.session("lidar", false, {"odometry", "planes", "backend"});
  sendKeyframe(0);
  EXPECT_EQ(ids(), std::vector<int64_t>{0});
}

TEST_F(PlanesNodeTest, UpstreamsReasonIsPassedOn) {
  source.session("lidar", false);
  sendKeyframe(0);
  odometryEnds(2, "1 message(s) of SPOT_ODOMETRY lost");
  EXPECT_EQ(node.whyNot(), "1 message(s) of SPOT_ODOMETRY lost");
}

TEST_F(PlanesNodeTest, ARefusedMessageAndUpstreamsReasonAreBothSaid) {
  source.session("lidar", false);
  bus.publish("KEYFRAME", std::vector<uint8_t>{1, 2, 3});
  bus.dispatch(0);
  odometryEnds(-1, "stopped");
  EXPECT_EQ(node.whyNot(), "1 message(s) of KEYFRAME refused (undecodable); stopped");
}

TEST_F(PlanesNodeTest, HostileContentIsRefusedAndDoesNotStopTheStream) {
  source.session("lidar", false);
  sendKeyframe(0);
  keyframe_t m = chunksOf(0)[0];
  source.send(channels::kKeyframe, m);  // again
  m.keyframe = -1;
  source.send(channels::kKeyframe, m);
  m.keyframe = 1LL << 60;
  source.send(channels::kKeyframe, m);
  m.keyframe = 1;
  m.num_chunks = 1 << 30;
  source.send(channels::kKeyframe, m);
  m.num_chunks = 1;
  m.chunk = 3;
  source.send(channels::kKeyframe, m);
  EXPECT_EQ(refused(), 5);
  EXPECT_EQ(ids(), std::vector<int64_t>{0});
  sendKeyframe(1);
  EXPECT_EQ(ids(), (std::vector<int64_t>{0, 1}));

  Source other(bus, 8);
  other.send(channels::kKeyframe, chunksOf(2)[0]);
  EXPECT_EQ(refused(), 6);
}

TEST_F(PlanesNodeTest, AKeyframeWithContentThatCannotBeHasNoPlanes) {
  source.session("lidar", false);
  keyframe_t m = chunksOf(0, 100)[0];
  m.T_odom_body.xyz[0] = NAN;
  source.send(channels::kKeyframe, m);
  sendKeyframe(1);
  ASSERT_EQ(ids(), (std::vector<int64_t>{0, 1}));
  EXPECT_EQ(planes.messages[0].num_planes, 0);
  EXPECT_EQ(refused(), 1);
}

TEST_F(PlanesNodeTest, FinishEndsAStreamThatHasNoEnd) {
  source.session("lidar", false);
  source.send(channels::kKeyframe, chunksOf(0)[0]);
  node.finish("stopped by a signal");
  bus.dispatch(0);
  EXPECT_EQ(ids(), std::vector<int64_t>{0});
  EXPECT_EQ(node.whyNot(), "stopped by a signal");
  node.repeatEnd();
  bus.dispatch(0);
  ASSERT_EQ(ends.messages.size(), 2u);
  EXPECT_EQ(ends.messages[1].header.seq, ends.messages[0].header.seq);
  sendKeyframe(1);
  EXPECT_EQ(planes.messages.size(), 1u) << "after the end nothing follows";
}

TEST_F(PlanesNodeTest, StreamEndAnnouncesTheEnd) {
  source.session("lidar", false);
  EXPECT_FALSE(node.streamEnded());
  source.end();
  EXPECT_TRUE(node.streamEnded());
  EXPECT_FALSE(node.done());
}

TEST_F(PlanesNodeTest, StatusShowsWhatCameAndWhatWent) {
  Recorder<status_t> status(bus, channels::kStatusPlanes);
  node.publishStatus();
  source.session("lidar", false);
  sendKeyframe(0);
  node.publishStatus();
  bus.dispatch(0);
  ASSERT_EQ(status.messages.size(), 2u);
  EXPECT_EQ(status.messages[0].state, "waiting for SESSION");
  EXPECT_EQ(status.messages[1].state, "running");
  EXPECT_EQ(status.messages[1].header.utime, Source::at(1).us);
  EXPECT_EQ(node.stepLatency().count(), 1);
}

}  // namespace
}  // namespace sgraphs
