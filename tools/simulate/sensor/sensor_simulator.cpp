#include "tools/simulate/sensor/sensor_simulator.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>

#include "common/geometry/degree.h"
#include "tools/simulate/sensor/random_stream.h"

namespace sgraphs::simulate {
namespace {

using namespace vlp16;

constexpr int64_t kPacketsPerTask = 16;

void put16(uint8_t* at, uint32_t value) {
  at[0] = static_cast<uint8_t>(value);
  at[1] = static_cast<uint8_t>(value >> 8);
}

// Share of the light that comes back shrinks as a surface is seen more obliquely.
uint8_t reflectivityOf(const RayHit& hit) {
  return static_cast<uint8_t>(std::lround(hit.reflectivity * (0.4 + 0.6 * hit.cos_incidence)));
}

// Glass, a model of ours after what is known of panes under a LiDAR: smooth glass throws light back to the
// sensor near normal incidence only (Foster, Sun, Park and Kuipers, "VisAGGE: visible angle grid for glass
// environments", ICRA 2013); the rest goes through. Ghosts, seen in a pane as in a mirror, are left out.
constexpr double kGlassCone_rad = 12 * kDegree_rad;  // no return beyond this incidence
constexpr double kGlassChance = 0.8;                 // of a return at normal incidence
constexpr double kFaintestShare = 0.25;              // fainter echoes from behind glass are not noticed
constexpr double kGlassStep_m = 1e-3;                // between a pane and the search for the next
constexpr uint64_t kGlassSeed = 0x676c617373;        // draws apart from those of noise and drop-outs

double glassReturnChance(double cos_incidence) {
  const double x = std::acos(cos_incidence) / kGlassCone_rad;
  return x < 1 ? kGlassChance * (1 - x * x) : 0.0;
}

// Share of light that passes a pane: Fresnel's reflectance of each of its two surfaces by Schlick's
// approximation for a refractive index of 1.5, with all reflections between them.
double glassTransmittance(double cos_incidence) {
  const double reflected = 0.04 + 0.96 * std::pow(1 - cos_incidence, 5);
  return (1 - reflected) / (1 + reflected);
}

}  // namespace

uint32_t microsecondsPastHour(Time time) {
  constexpr int64_t kHour_us = 3600000000;
  return static_cast<uint32_t>(((time.us % kHour_us) + kHour_us) % kHour_us);
}

SensorSimulator::SensorSimulator(const RayCaster& building, const Trajectory& trajectory,
                                 const SE3& T_body_lidar, const SensorModel& model, uint64_t seed,
                                 People people, LiftDoors doors)
    : building_(building),
      trajectory_(trajectory),
      T_body_lidar_(T_body_lidar),
      model_(model),
      seed_(seed),
      people_(std::move(people)),
      doors_(std::move(doors)) {
  for (size_t i = 0; i < kLasers; ++i) {
    cos_elevation_[i] = std::cos(kElevation_deg[i] * kDegree_rad);
    sin_elevation_[i] = std::sin(kElevation_deg[i] * kDegree_rad);
  }
}

double SensorSimulator::azimuthDeg(double offset_us) const {
  return model_.start_azimuth_deg + model_.rpm * 6e-6 * offset_us;
}

std::optional<RayHit> SensorSimulator::firstReturn(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
                                                   const MovingNow& moving, uint64_t firing) const {
  auto hit = building_.cast(origin, ray, model_.max_range_m);
  const auto reach_m = [&] { return hit ? hit->range_m : model_.max_range_m; };
  if (!moving.people.empty())
    if (const auto person = moving.people.cast(origin, ray, reach_m())) hit = person;
  if (!moving.doors.empty())
    if (const auto door = moving.doors.cast(origin, ray, reach_m())) hit = door;
  if (!building_.hasGlass()) return hit;
  RandomStream random(seed_ ^ kGlassSeed, firing);
  const double end_m = hit ? hit->range_m : model_.max_range_m;
  double begin_m = 0, kept = 1;  // share of the light that comes back through the panes so far
  while (const auto pane = building_.castGlass(origin, ray, begin_m, end_m)) {
    if (random.uniform() < kept * glassReturnChance(pane->cos_incidence)) return pane;
    kept *= std::pow(glassTransmittance(pane->cos_incidence), 2);
    begin_m = pane->range_m + kGlassStep_m;
  }
  if (!hit || kept < kFaintestShare) return std::nullopt;
  hit->reflectivity = static_cast<uint8_t>(std::lround(hit->reflectivity * kept));
  return hit;
}

SensorSimulator::Return SensorSimulator::measure(int64_t sequence, int laser, const MovingNow& moving,
                                                 double noise, double chance) const {
  const auto i = static_cast<size_t>(laser);
  const double offset_us = static_cast<double>(sequence) * kSequencePeriod_us + laser * kLaserPeriod_us;
  const double azimuth = azimuthDeg(offset_us) * kDegree_rad;
  const Eigen::Vector3d ray_lidar(cos_elevation_[i] * std::cos(azimuth),
                                  -cos_elevation_[i] * std::sin(azimuth), sin_elevation_[i]);
  const SE3 T_building_lidar = trajectory_.seenPoseAtOffset(offset_us * 1e-6) * T_body_lidar_;
  const Eigen::Vector3d origin = T_building_lidar * Eigen::Vector3d(0, 0, kVerticalOffset_mm[i] * 1e-3);
  const auto hit = firstReturn(origin, T_building_lidar.rotation * ray_lidar, moving,
                               static_cast<uint64_t>(sequence * kLasers + laser));
  if (!hit || hit->range_m < model_.min_range_m) return {};
  const double incidence_deg = std::acos(hit->cos_incidence) / kDegree_rad;
  if (incidence_deg > model_.grazing_drop_deg) {
    const double x = (incidence_deg - model_.grazing_drop_deg) / (90.0 - model_.grazing_drop_deg);
    if (chance < x * x) return {};
  }
  const double steps = std::round((hit->range_m + model_.range_sigma_m * noise) / kRangeStep_m);
  return {std::clamp(steps, 1.0, 65535.0) * kRangeStep_m, reflectivityOf(*hit)};
}

std::array<SensorSimulator::Return, kLasers> SensorSimulator::fire(int64_t sequence) const {
  RandomStream random(seed_, static_cast<uint64_t>(sequence));
  const double seconds = static_cast<double>(sequence) * kSequencePeriod_us * 1e-6;
  const MovingNow moving{people_.at(seconds), doors_.at(seconds)};
  std::array<Return, kLasers> returns;
  for (int laser = 0; laser < kLasers; ++laser) {
    const double noise = random.normal(), chance = random.uniform();
    returns[static_cast<size_t>(laser)] = measure(sequence, laser, moving, noise, chance);
  }
  return returns;
}

int64_t SensorSimulator::numPackets() const {
  return static_cast<int64_t>(static_cast<double>(trajectory_.duration().us) / kPacketPeriod_us);
}

SensorPacket SensorSimulator::packet(int64_t index) const {
  SensorPacket out;
  out.time = trajectory_.start() + Duration{std::llround(static_cast<double>(index) * kPacketPeriod_us)};
  uint8_t* at = out.bytes.data();
  for (int block = 0; block < kBlocks; ++block) {
    const int64_t first = index * kSequencesPerPacket + int64_t{block} * kSequencesPerBlock;
    const auto azimuth = std::llround(azimuthDeg(static_cast<double>(first) * kSequencePeriod_us) * 100.0);
    put16(at, 0xEEFF);
    put16(at + 2, static_cast<uint32_t>(((azimuth % 36000) + 36000) % 36000));
    at += 4;
    for (int64_t sequence = first; sequence < first + kSequencesPerBlock; ++sequence)
      for (const Return& r : fire(sequence)) {
        put16(at, static_cast<uint32_t>(std::lround(r.range_m / kRangeStep_m)));
        at[2] = r.reflectivity;
        at += 3;
      }
  }
  const uint32_t stamp = microsecondsPastHour(out.time);
  put16(at, stamp);
  put16(at + 2, stamp >> 16);
  at[4] = 0x37;
  at[5] = 0x22;
  return out;
}

std::vector<SensorPacket> SensorSimulator::packets(int64_t first, int64_t count, int num_threads) const {
  std::vector<SensorPacket> out(static_cast<size_t>(std::max<int64_t>(count, 0)));
  std::atomic<int64_t> next{0};
  const auto work = [&] {
    for (int64_t begin; (begin = next.fetch_add(kPacketsPerTask)) < count;)
      for (int64_t i = begin; i < std::min(begin + kPacketsPerTask, count); ++i)
        out[static_cast<size_t>(i)] = packet(first + i);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < num_threads; ++i) helpers.emplace_back(work);
  work();
  helpers.clear();  // joins them
  return out;
}

int64_t SensorSimulator::numScans() const {
  const double revolution_us = 60e6 / model_.rpm;
  return static_cast<int64_t>(static_cast<double>(trajectory_.duration().us) / revolution_us);
}

LidarScan SensorSimulator::scan(int64_t index) const {
  const double sequences = 60e6 / model_.rpm / kSequencePeriod_us;  // per revolution
  const auto first = static_cast<int64_t>(std::ceil(static_cast<double>(index) * sequences));
  const auto last = static_cast<int64_t>(std::ceil(static_cast<double>(index + 1) * sequences)) - 1;
  const auto instant_us = [](int64_t sequence, int laser) {
    return std::llround(static_cast<double>(sequence) * kSequencePeriod_us + laser * kLaserPeriod_us);
  };
  LidarScan scan;
  scan.begin = trajectory_.start() + Duration{instant_us(first, 0)};
  scan.end = trajectory_.start() + Duration{instant_us(last, kLasers - 1)};
  scan.sequence = index;
  scan.num_rings = kLasers;
  for (int64_t sequence = first; sequence <= last; ++sequence) {
    const auto returns = fire(sequence);
    for (int laser = 0; laser < kLasers; ++laser) {
      const auto i = static_cast<size_t>(laser);
      const double range = returns[i].range_m;
      if (range <= 0) continue;
      const double offset_us = static_cast<double>(sequence) * kSequencePeriod_us + laser * kLaserPeriod_us;
      const double azimuth = azimuthDeg(offset_us) * kDegree_rad, flat = range * cos_elevation_[i];
      LidarPoint point;
      point.position_lidar = Eigen::Vector3d(flat * std::cos(azimuth), -flat * std::sin(azimuth),
                                             range * sin_elevation_[i] + kVerticalOffset_mm[i] * 1e-3)
                                 .cast<float>();
      point.time_us = static_cast<int32_t>((trajectory_.start() - scan.end).us + instant_us(sequence, laser));
      point.column = static_cast<uint16_t>(sequence - first);
      point.ring = static_cast<uint8_t>(ring(laser));
      point.reflectivity = returns[i].reflectivity;
      scan.points.push_back(point);
    }
  }
  return scan;
}

}  // namespace sgraphs::simulate
