#pragma once

#include <memory>
#include <string>

#include "drivers/spot/spot_robot.h"

namespace sgraphs {

struct SpotAddress {
  std::string host;
  int port = 443;
  std::string root_cert_pem;  // the certificate's text
};

// A robot over gRPC and TLS: one channel per authority to the same address.
class GrpcSpotRobot : public SpotRobot {
 public:
  GrpcSpotRobot(SpotAddress address, Duration deadline);
  ~GrpcSpotRobot() override;

  void disconnect() override;
  Answer<AuthReply> login(const Credentials& credentials) override;
  Answer<AuthReply> renew(const std::string& user, const std::string& token) override;
  Answer<std::string> authorityOf(const std::string& service, const std::string& token) override;
  Answer<TimeSyncReply> syncTime(const std::string& authority, const std::string& token,
                                 const TimeSyncRequest& request) override;
  Answer<StateReply> readState(const std::string& authority, const std::string& token) override;

 private:
  struct Connections;
  std::unique_ptr<Connections> connections_;
};

}  // namespace sgraphs
