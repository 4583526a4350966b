#include "tests/drivers/spot/fake_robot.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>

#include "drivers/host_clock.h"
#include "drivers/spot/wire.h"
#include "spot_wire.grpc.pb.h"
#include "tests/drivers/spot/fake_certificate.h"

namespace sgraphs::test {
namespace {

namespace api = bosdyn::api;
using grpc::Status;

// Those of login and directory are fixed; the others are unlike any real robot's, so that only who asks the
// directory finds them.
constexpr const char* kAuthAuthority = "auth.spot.robot";
constexpr const char* kDirectoryAuthority = "api.spot.robot";
constexpr const char* kClockAuthority = "clock.fake.robot";
constexpr const char* kStateAuthority = "legs.fake.robot";
constexpr int kLoginsToLockout = 6;
constexpr size_t kRoundsToEstimate = 3;
constexpr size_t kRoundsKept = 10;
constexpr int kCodeOk = 1, kCodeInvalidRequest = 3;

void addEdge(api::FrameTreeSnapshot& tree, const std::string& child, const std::string& parent,
             const SE3& T) {
  auto& edge = (*tree.mutable_child_to_parent_edge_map())[child];
  edge.set_parent_frame_name(parent);
  *edge.mutable_parent_tform_child() = wire::toWire(T);
}

void fillFrames(FakeFrames frames, const SE3& T_odom_body, api::FrameTreeSnapshot& tree) {
  const SE3 T_vision_body = fakeVisionOdom() * T_odom_body;
  const SE3 T_other({0.6, 0, 0.8, 0}, {1, -2, 3});
  switch (frames) {
    case FakeFrames::kBodyRoot:
    case FakeFrames::kNoOdom:
      addEdge(tree, "body", "", {});
      addEdge(tree, "vision", "body", T_vision_body.inverse());
      if (frames == FakeFrames::kBodyRoot) addEdge(tree, "odom", "body", T_odom_body.inverse());
      return;
    case FakeFrames::kOdomRoot:
      addEdge(tree, "odom", "", {});
      addEdge(tree, "body", "odom", T_odom_body);
      addEdge(tree, "vision", "odom", fakeVisionOdom().inverse());
      return;
    case FakeFrames::kDeep:
      addEdge(tree, "vision", "", {});
      addEdge(tree, "gpe", "vision", T_other);
      addEdge(tree, "odom", "gpe", T_other.inverse() * fakeVisionOdom());
      addEdge(tree, "flat_body", "vision", T_other);
      addEdge(tree, "body", "flat_body", T_other.inverse() * T_vision_body);
      return;
    case FakeFrames::kCircle:
      addEdge(tree, "body", "odom", T_odom_body);
      addEdge(tree, "odom", "body", T_odom_body.inverse());
      addEdge(tree, "vision", "body", T_vision_body.inverse());
      return;
  }
}

}  // namespace

// Has a name, as FakeRobot::Server has one, which is made of it.
namespace fake_robot {

// What the services share.
struct State {
  std::mutex mutex;
  FakeRobotOptions options;
  FakeCalls calls;
  std::set<std::string> tokens;
  std::string last_token;
  int refused_in_a_row = 0, issued = 0;
  Duration clock_offset, slowness;
  bool clock_ready = true, nan = false, talkative = false, locked_out = false;
  FakeFrames frames = FakeFrames::kBodyRoot;
  std::optional<Time> frozen;
  int clocks = 0;
  std::map<std::string, std::deque<ClockEstimate>> estimates;  // by clock identifier

  Time robotNow() const { return hostClock() + clock_offset; }
  api::ResponseHeader header(Time received, int code = kCodeOk) const {
    api::ResponseHeader header;
    *header.mutable_request_received_timestamp() = wire::toWire(received);
    *header.mutable_response_timestamp() = wire::toWire(robotNow());
    header.mutable_error()->set_code(code);
    return header;
  }
  // Whether the call came to the right place, with a valid token.
  Status admit(const grpc::ServerContext& context, const std::string& authority, bool with_token) {
    const grpc::string_ref asked = context.ExperimentalGetAuthority();
    if (std::string(asked.data(), asked.size()) != authority) {
      ++calls.wrong_authority;
      return {grpc::StatusCode::UNIMPLEMENTED, "no such service at this authority"};
    }
    if (!with_token) return Status::OK;
    const auto found = context.client_metadata().find("authorization");
    const std::string given = found == context.client_metadata().end()
                                  ? ""
                                  : std::string(found->second.data(), found->second.size());
    if (given.rfind("Bearer ", 0) == 0 && tokens.count(given.substr(7))) return Status::OK;
    ++calls.without_token;
    return {grpc::StatusCode::UNAUTHENTICATED, "no valid token"};
  }
};

class Auth : public api::AuthService::Service {
 public:
  explicit Auth(State& state) : state_(state) {}
  Status GetAuthToken(grpc::ServerContext* context, const api::GetAuthTokenRequest* request,
                      api::GetAuthTokenResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const Time received = state_.robotNow();
    if (Status admitted = state_.admit(*context, kAuthAuthority, false); !admitted.ok()) return admitted;
    response->set_status(answer(*request));
    if (response->status() == api::GetAuthTokenResponse::STATUS_OK) {
      state_.last_token = "eyJhbGciOi.fake." + std::to_string(++state_.issued);
      state_.tokens.insert(state_.last_token);
      response->set_token(state_.last_token);
    }
    *response->mutable_header() = state_.header(received);
    return Status::OK;
  }

 private:
  api::GetAuthTokenResponse::Status answer(const api::GetAuthTokenRequest& request) {
    if (!request.token().empty()) {
      ++state_.calls.renewals;
      return state_.tokens.count(request.token()) ? api::GetAuthTokenResponse::STATUS_OK
                                                  : api::GetAuthTokenResponse::STATUS_INVALID_TOKEN;
    }
    ++state_.calls.logins;
    if (state_.locked_out || state_.refused_in_a_row >= kLoginsToLockout)
      return api::GetAuthTokenResponse::STATUS_TEMPORARILY_LOCKED_OUT;
    if (request.username() != state_.options.user || request.password() != state_.options.password) {
      ++state_.refused_in_a_row;
      ++state_.calls.refused_logins;
      return api::GetAuthTokenResponse::STATUS_INVALID_LOGIN;
    }
    state_.refused_in_a_row = 0;
    return api::GetAuthTokenResponse::STATUS_OK;
  }
  State& state_;
};

class Directory : public api::DirectoryService::Service {
 public:
  explicit Directory(State& state) : state_(state) {}
  Status GetServiceEntry(grpc::ServerContext* context, const api::GetServiceEntryRequest* request,
                         api::GetServiceEntryResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    if (Status admitted = state_.admit(*context, kDirectoryAuthority, true); !admitted.ok()) return admitted;
    const std::map<std::string, std::string> services{{"robot-state", kStateAuthority},
                                                      {"time-sync", kClockAuthority}};
    const auto found = services.find(request->service_name());
    *response->mutable_header() = state_.header(state_.robotNow());
    response->set_status(found == services.end() ? api::GetServiceEntryResponse::STATUS_NONEXISTENT_SERVICE
                                                 : api::GetServiceEntryResponse::STATUS_OK);
    if (found != services.end()) response->mutable_service_entry()->set_authority(found->second);
    return Status::OK;
  }

 private:
  State& state_;
};

// The robot's side of the exchange: skew and round trip of what the client reports, the best of the last
// ones.
class Clock : public api::TimeSyncService::Service {
 public:
  explicit Clock(State& state) : state_(state) {}
  Status TimeSyncUpdate(grpc::ServerContext* context, const api::TimeSyncUpdateRequest* request,
                        api::TimeSyncUpdateResponse* response) override {
    const std::lock_guard lock(state_.mutex);
    const Time received = state_.robotNow();
    if (Status admitted = state_.admit(*context, kClockAuthority, true); !admitted.ok()) return admitted;
    ++state_.calls.time_syncs;
    if (request->has_previous_round_trip() && request->clock_identifier().empty()) {
      *response->mutable_header() = state_.header(received, kCodeInvalidRequest);
      return Status::OK;
    }
    const std::string id = request->clock_identifier().empty() ? "clock " + std::to_string(++state_.clocks)
                                                               : request->clock_identifier();
    response->set_clock_identifier(id);
    if (!state_.clock_ready) {
      response->mutable_state()->set_status(api::TimeSyncState::STATUS_SERVICE_NOT_READY);
    } else {
      std::deque<ClockEstimate>& known = state_.estimates[id];
      if (request->has_previous_round_trip()) known.push_back(estimateOf(request->previous_round_trip()));
      if (known.size() > kRoundsKept) known.pop_front();
      fill(known, *response->mutable_state());
    }
    *response->mutable_header() = state_.header(received);
    return Status::OK;
  }

 private:
  static ClockEstimate estimateOf(const api::TimeSyncRoundTrip& trip) {
    const Duration out = wire::fromWire(trip.server_rx()) - wire::fromWire(trip.client_tx());
    const Duration back = wire::fromWire(trip.server_tx()) - wire::fromWire(trip.client_rx());
    return {{(out.us + back.us) / 2}, {out.us - back.us}};
  }
  static void fill(const std::deque<ClockEstimate>& known, api::TimeSyncState& state) {
    state.set_status(known.size() < kRoundsToEstimate ? api::TimeSyncState::STATUS_MORE_SAMPLES_NEEDED
                                                      : api::TimeSyncState::STATUS_OK);
    const auto best = std::min_element(
        known.begin(), known.end(), [](const auto& a, const auto& b) { return a.round_trip < b.round_trip; });
    if (best == known.end()) return;
    *state.mutable_best_estimate()->mutable_clock_skew() = wire::toWire(best->skew);
    *state.mutable_best_estimate()->mutable_round_trip_time() = wire::toWire(best->round_trip);
  }
  State& state_;
};

class Legs : public api::RobotStateService::Service {
 public:
  explicit Legs(State& state) : state_(state) {}
  Status GetRobotState(grpc::ServerContext* context, const api::RobotStateRequest* /*request*/,
                       api::RobotStateResponse* response) override {
    Duration slowness;
    {
      const std::lock_guard lock(state_.mutex);
      ++state_.calls.states;
      slowness = state_.slowness;
    }
    if (slowness.us > 0) std::this_thread::sleep_for(std::chrono::microseconds(slowness.us));
    const std::lock_guard lock(state_.mutex);
    if (Status admitted = state_.admit(*context, kStateAuthority, true); !admitted.ok()) return admitted;
    if (state_.talkative)
      return {grpc::StatusCode::INTERNAL,
              "failed\nfor password " + state_.options.password + " and token " + state_.last_token};
    const int64_t period_us = state_.options.state_period.us;
    const Time host = state_.frozen ? *state_.frozen : Time{hostClock().us / period_us * period_us};
    *response->mutable_header() = state_.header(state_.robotNow());
    fill(host, *response->mutable_robot_state()->mutable_kinematic_state());
    return Status::OK;
  }

 private:
  void fill(Time host, api::KinematicState& kinematics) const {
    FakeMotion motion = state_.options.motion ? state_.options.motion(host) : FakeMotion{};
    const Eigen::Quaterniond q_vision_odom = fakeVisionOdom().rotation;
    if (state_.nan) motion.T_odom_body.translation.x() = std::numeric_limits<double>::quiet_NaN();
    *kinematics.mutable_acquisition_timestamp() = wire::toWire(host + state_.clock_offset);
    fillFrames(state_.frames, motion.T_odom_body, *kinematics.mutable_transforms_snapshot());
    const auto set = [](api::SE3Velocity& velocity, const Eigen::Vector3d& linear,
                        const Eigen::Vector3d& angular) {
      *velocity.mutable_linear() = wire::toWire(linear);
      *velocity.mutable_angular() = wire::toWire(angular);
    };
    set(*kinematics.mutable_velocity_of_body_in_odom(), motion.linear_odom_mps, motion.angular_odom_radps);
    set(*kinematics.mutable_velocity_of_body_in_vision(), q_vision_odom * motion.linear_odom_mps,
        q_vision_odom * motion.angular_odom_radps);
  }
  State& state_;
};

}  // namespace fake_robot

SE3 fakeVisionOdom() {
  return {so3Exp({0, 0, 0.5}), {0.3, -0.2, 0.1}};
}

struct FakeRobot::Server {
  fake_robot::State state;
  fake_robot::Auth auth{state};
  fake_robot::Directory directory{state};
  fake_robot::Clock clock{state};
  fake_robot::Legs legs{state};
  FakeCertificate certificate =
      makeCertificate({kAuthAuthority, kDirectoryAuthority, kClockAuthority, kStateAuthority});
  int port = 0;
  std::unique_ptr<grpc::Server> server;
};

FakeRobot::FakeRobot(const FakeRobotOptions& options) : server_(std::make_unique<Server>()) {
  server_->state.options = options;
  server_->port = options.port;
  start();
}

FakeRobot::~FakeRobot() {
  stop();
}

void FakeRobot::start() {
  grpc::SslServerCredentialsOptions tls;
  tls.pem_key_cert_pairs.push_back({server_->certificate.key_pem, server_->certificate.certificate_pem});
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:" + std::to_string(server_->port), grpc::SslServerCredentials(tls),
                           &port);
  for (grpc::Service* service : std::initializer_list<grpc::Service*>{&server_->auth, &server_->directory,
                                                                      &server_->clock, &server_->legs})
    builder.RegisterService(service);
  server_->server = builder.BuildAndStart();
  if (!server_->server || port == 0) throw std::runtime_error("the fake robot finds no free port");
  server_->port = port;
}

void FakeRobot::stop() {
  if (!server_->server) return;
  server_->server->Shutdown(std::chrono::system_clock::now());
  server_->server.reset();
}

int FakeRobot::port() const {
  return server_->port;
}

const std::string& FakeRobot::rootCertPem() const {
  return server_->certificate.certificate_pem;
}

FakeCalls FakeRobot::calls() const {
  const std::lock_guard lock(server_->state.mutex);
  return server_->state.calls;
}

std::string FakeRobot::lastToken() const {
  const std::lock_guard lock(server_->state.mutex);
  return server_->state.last_token;
}

void FakeRobot::setClockOffset(Duration offset) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.clock_offset = offset;
}

void FakeRobot::setClockServiceReady(bool ready) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.clock_ready = ready;
}

void FakeRobot::setFrames(FakeFrames frames) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.frames = frames;
}

void FakeRobot::setNanPoses(bool nan) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.nan = nan;
}

void FakeRobot::setFrozenState(bool frozen) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.frozen = frozen ? std::optional(hostClock()) : std::nullopt;
}

void FakeRobot::setSlowness(Duration slowness) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.slowness = slowness;
}

void FakeRobot::setTalkative(bool talkative) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.talkative = talkative;
}

void FakeRobot::setLockedOut(bool locked_out) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.locked_out = locked_out;
}

void FakeRobot::setPassword(const std::string& password) {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.options.password = password;
}

void FakeRobot::expireTokens() {
  const std::lock_guard lock(server_->state.mutex);
  server_->state.tokens.clear();
}

}  // namespace sgraphs::test
