// Recordings of real sensors: what they hold is counted here from the raw bytes, independently of the
// decoder.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "drivers/velodyne/stamp_resolver.h"
#include "drivers/velodyne/vlp16_decoder.h"

namespace sgraphs {
namespace {

std::vector<uint8_t> readFile(const std::string& name) {
  std::ifstream in(std::string(SGRAPHS_SHARED_DATA_DIR) + "/vlp16/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

using Packets = std::vector<std::span<const uint8_t>>;

Packets rawPackets(const std::vector<uint8_t>& file) {
  Packets packets;
  for (size_t at = 0; at + 1206 <= file.size(); at += 1206) packets.emplace_back(&file[at], 1206);
  return packets;
}

// Classic little-endian pcap: 24-byte file header, 16-byte record headers, 42 bytes of Ethernet, IP and UDP.
Packets pcapPackets(const std::vector<uint8_t>& file) {
  Packets packets;
  for (size_t at = 24; at + 16 <= file.size();) {
    const size_t length = static_cast<size_t>(file[at + 8] | file[at + 9] << 8);
    if (length == 42 + 1206) packets.emplace_back(&file[at + 16 + 42], 1206);
    at += 16 + length;
  }
  return packets;
}

// Whole turns between the first and the last passage through the cut angle.
int fullTurns(const Packets& packets, double cut_deg) {
  double unwrapped_cdeg = -1, first_cdeg = 0;
  for (const auto packet : packets)
    for (int block = 0; block < kVlp16Blocks; ++block) {
      const int raw = rawAzimuth_cdeg(packet, block);
      if (raw >= 36000) continue;
      if (unwrapped_cdeg < 0)
        unwrapped_cdeg = first_cdeg = raw;
      else
        unwrapped_cdeg += std::remainder(raw - unwrapped_cdeg, 36000.0);
    }
  const double cut_cdeg = 100 * cut_deg;
  return static_cast<int>(std::floor((unwrapped_cdeg - cut_cdeg) / 36000) -
                          std::floor((first_cdeg - cut_cdeg) / 36000)) -
         1;
}

std::vector<LidarScan> decode(const Packets& packets, double cut_deg, Vlp16Counts* counts = nullptr) {
  Vlp16Config config;
  config.cut_azimuth_deg = cut_deg;
  RevolutionAssembler assembler(config);
  StampResolver resolver(StampResolver::Clock::kCarried);
  std::vector<LidarScan> scans;
  for (const auto packet : packets) {
    Vlp16Packet parsed;
    if (parsePacket(packet, parsed) != PacketFault::kNone) continue;
    const Time time = resolver.resolve(parsed.stamp_us,
                                       scans.empty() ? std::optional(Time{1'000'000'000'000}) : std::nullopt);
    if (auto scan = assembler.step(time, packet)) scans.push_back(std::move(*scan));
  }
  if (counts) *counts = assembler.counts();
  return scans;
}

TEST(RealRecordingTest, TenHertzRecordingHoldsItsFullRevolutionsAtAnyCut) {
  const std::vector<uint8_t> file = readFile("einride_recording.bin");
  if (file.empty()) GTEST_SKIP() << "shared data absent: vlp16/einride_recording.bin";
  const Packets packets = rawPackets(file);
  ASSERT_EQ(packets.size(), 1000u);
  for (int cut_deg = 0; cut_deg < 360; cut_deg += 45) {
    Vlp16Counts counts;
    const auto scans = decode(packets, cut_deg, &counts);
    EXPECT_EQ(static_cast<int>(scans.size()), fullTurns(packets, cut_deg)) << "cut at " << cut_deg;
    EXPECT_GE(scans.size(), 12u) << "cut at " << cut_deg;
    EXPECT_EQ(counts.lost_packets, 0);
    EXPECT_EQ(counts.packets, 1000);
    for (const LidarScan& scan : scans) EXPECT_NEAR((scan.end - scan.begin).seconds(), 0.1, 2e-3);
  }
}

TEST(RealRecordingTest, TwentyHertzRecordingOfOldFirmware) {
  const std::vector<uint8_t> file = readFile("veloview_vlp-16-test-90deg-1-50-frames.pcap");
  if (file.empty()) GTEST_SKIP() << "shared data absent: vlp16/veloview_vlp-16-test-90deg-1-50-frames.pcap";
  const Packets packets = pcapPackets(file);
  ASSERT_EQ(packets.size(), 1902u);
  for (int cut_deg = 0; cut_deg < 360; cut_deg += 45) {
    Vlp16Counts counts;
    const auto scans = decode(packets, cut_deg, &counts);
    EXPECT_EQ(static_cast<int>(scans.size()), fullTurns(packets, cut_deg)) << "cut at " << cut_deg;
    EXPECT_GE(scans.size(), 49u) << "cut at " << cut_deg;
    EXPECT_EQ(counts.repaired_azimuths, 1);
    EXPECT_EQ(counts.lost_packets, 0);
    for (const LidarScan& scan : scans) EXPECT_NEAR((scan.end - scan.begin).seconds(), 0.05, 1e-3);
  }
}

}  // namespace
}  // namespace sgraphs
