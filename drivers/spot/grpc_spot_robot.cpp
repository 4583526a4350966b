#include "drivers/spot/grpc_spot_robot.h"

#include <grpc/support/log.h>
#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "drivers/host_clock.h"
#include "drivers/spot/wire.h"
#include "spot_wire.grpc.pb.h"

namespace sgraphs {
namespace {

namespace api = bosdyn::api;

// The two that must be known before the directory can be asked.
constexpr const char* kAuthAuthority = "auth.spot.robot";
constexpr const char* kDirectoryAuthority = "api.spot.robot";
constexpr int kNoError = 1;  // CommonError.code
constexpr size_t kMaxWhy = 160;

// What a stranger wrote, made fit for one line of a log.
std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  if (text.size() > kMaxWhy) text.resize(kMaxWhy);
  return text;
}

CallStatus statusOf(grpc::StatusCode code) {
  switch (code) {
    case grpc::StatusCode::OK:
      return CallStatus::kOk;
    case grpc::StatusCode::UNAUTHENTICATED:
      return CallStatus::kUnauthenticated;
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::CANCELLED:
      return CallStatus::kUnavailable;
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return CallStatus::kTimeout;
    default:
      return CallStatus::kRefused;
  }
}

std::string describe(const grpc::Status& status) {
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED) return "no answer within the deadline";
  if (status.error_message().find("certificate verify failed") != std::string::npos)
    return "the robot's certificate is not signed by the one of --root-cert";
  const std::string text = oneLine(status.error_message());
  const std::string code = std::to_string(static_cast<int>(status.error_code()));
  return text.empty() ? "gRPC status " + code : text + " (gRPC status " + code + ")";
}

}  // namespace

struct GrpcSpotRobot::Connections {
  SpotAddress address;
  Duration deadline;
  std::map<std::string, std::shared_ptr<grpc::Channel>> channels;

  std::shared_ptr<grpc::Channel> channel(const std::string& authority) {
    std::shared_ptr<grpc::Channel>& channel = channels[authority];
    if (!channel) {
      grpc::SslCredentialsOptions tls;
      tls.pem_root_certs = address.root_cert_pem;
      grpc::ChannelArguments arguments;
      // Both the name in the certificate and the :authority of every call.
      arguments.SetSslTargetNameOverride(authority);
      // Pauses between tries are ours alone: a channel that could not connect is thrown away.
      arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
      arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
      const std::string host =
          address.host.find(':') == std::string::npos ? address.host : "[" + address.host + "]";
      channel = grpc::CreateCustomChannel(host + ":" + std::to_string(address.port),
                                          grpc::SslCredentials(tls), arguments);
    }
    return channel;
  }

  // One call with its deadline; `method` is a member of the service's stub.
  template <typename Service, typename Request, typename Response>
  Answer<Response> call(const std::string& authority, const std::string& token,
                        grpc::Status (Service::Stub::*method)(grpc::ClientContext*, const Request&,
                                                              Response*),
                        const Request& request) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::microseconds(deadline.us));
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    typename Service::Stub stub(channel(authority));
    Answer<Response> answer;
    const grpc::Status status = (stub.*method)(&context, request, &answer.value);
    answer.status = statusOf(status.error_code());
    if (!status.ok()) {
      answer.why = describe(status);
    } else if (const int code = answer.value.header().error().code(); code > kNoError) {
      answer.status = CallStatus::kRefused;
      answer.why = "the robot reports error " + std::to_string(code);
    }
    return answer;
  }
};

GrpcSpotRobot::GrpcSpotRobot(SpotAddress address, Duration deadline)
    : connections_(new Connections{std::move(address), deadline, {}}) {
  // The library writes to stderr on its own, several lines per failed handshake; what matters comes back as
  // an answer.
  gpr_set_log_function([](gpr_log_func_args*) {});
}

GrpcSpotRobot::~GrpcSpotRobot() = default;

void GrpcSpotRobot::disconnect() {
  connections_->channels.clear();
}

namespace {

template <typename To, typename From, typename Convert>
Answer<To> converted(Answer<From> from, Convert convert) {
  Answer<To> to{from.status, std::move(from.why), {}};
  if (to.ok()) to.value = convert(from.value);
  return to;
}

AuthReply authReply(const api::GetAuthTokenResponse& response) {
  return {wire::fromWire(response.status()), response.token()};
}

}  // namespace

Answer<AuthReply> GrpcSpotRobot::login(const Credentials& credentials) {
  // A call without any secret says whether somebody is there. After it, a login that fails may have been
  // carried out, and a refusal been lost: it must not be repeated soon.
  const Answer<std::string> probe = authorityOf("auth", "");
  if (probe.status == CallStatus::kUnavailable || probe.status == CallStatus::kTimeout)
    return {CallStatus::kUnavailable, probe.why, {}};
  api::GetAuthTokenRequest request;
  *request.mutable_header() = wire::requestHeader(hostClock());
  request.set_username(credentials.user);
  request.set_password(credentials.password);
  auto answer = connections_->call<api::AuthService>(kAuthAuthority, "",
                                                     &api::AuthService::Stub::GetAuthToken, request);
  if (answer.status == CallStatus::kUnavailable) answer.status = CallStatus::kTimeout;
  return converted<AuthReply>(std::move(answer), authReply);
}

Answer<AuthReply> GrpcSpotRobot::renew(const std::string& user, const std::string& token) {
  api::GetAuthTokenRequest request;
  *request.mutable_header() = wire::requestHeader(hostClock());
  request.set_username(user);
  request.set_token(token);
  return converted<AuthReply>(connections_->call<api::AuthService>(
                                  kAuthAuthority, "", &api::AuthService::Stub::GetAuthToken, request),
                              authReply);
}

Answer<std::string> GrpcSpotRobot::authorityOf(const std::string& service, const std::string& token) {
  api::GetServiceEntryRequest request;
  *request.mutable_header() = wire::requestHeader(hostClock());
  request.set_service_name(service);
  auto answer = connections_->call<api::DirectoryService>(
      kDirectoryAuthority, token, &api::DirectoryService::Stub::GetServiceEntry, request);
  const std::string authority = answer.value.service_entry().authority();
  if (answer.ok() && (answer.value.status() != api::GetServiceEntryResponse::STATUS_OK || authority.empty()))
    return {CallStatus::kRefused, "the robot's directory has no service '" + service + "'", ""};
  return {answer.status, answer.why, authority};
}

Answer<TimeSyncReply> GrpcSpotRobot::syncTime(const std::string& authority, const std::string& token,
                                              const TimeSyncRequest& request) {
  const Time sent = hostClock();
  auto answer = connections_->call<api::TimeSyncService>(
      authority, token, &api::TimeSyncService::Stub::TimeSyncUpdate, wire::toWire(request, sent));
  const Time received = hostClock();
  return converted<TimeSyncReply>(std::move(answer), [&](const api::TimeSyncUpdateResponse& response) {
    return wire::fromWire(response, sent, received);
  });
}

Answer<StateReply> GrpcSpotRobot::readState(const std::string& authority, const std::string& token) {
  const Time sent = hostClock();
  api::RobotStateRequest request;
  *request.mutable_header() = wire::requestHeader(sent);
  auto answer = connections_->call<api::RobotStateService>(
      authority, token, &api::RobotStateService::Stub::GetRobotState, request);
  const Time received = hostClock();
  return converted<StateReply>(std::move(answer), [&](const api::RobotStateResponse& response) {
    return StateReply{wire::fromWire(response.robot_state()), sent, received};
  });
}

}  // namespace sgraphs
