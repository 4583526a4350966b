#include "tools/run/doctor.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

using Level = Finding::Level;

// A bound socket on a free port of the loopback.
class Bound {
 public:
  explicit Bound(int type) : fd(socket(AF_INET, type, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_ANY);
    EXPECT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
    port = ntohs(address.sin_port);
  }
  ~Bound() { close(fd); }
  Bound(const Bound&) = delete;
  Bound& operator=(const Bound&) = delete;
  const int fd;
  int port = 0;
};

int freePort() {
  return Bound(SOCK_DGRAM).port;
}

TEST(DoctorTest, UrlsAreTakenApart) {
  const MulticastUrl url = parseMulticastUrl("udpm://239.1.2.3:7000?ttl=1&recv_buf_size=4000000");
  EXPECT_TRUE(url.is_udpm);
  EXPECT_EQ(url.address, "239.1.2.3");
  EXPECT_EQ(url.port, 7000);
  EXPECT_EQ(url.ttl, 1);
  EXPECT_EQ(url.recv_buf_size, 4'000'000);
  const MulticastUrl bare = parseMulticastUrl("udpm://");
  EXPECT_EQ(bare.address, "239.255.76.67");
  EXPECT_EQ(bare.port, 7667);
  EXPECT_EQ(bare.ttl, 0);
  EXPECT_FALSE(parseMulticastUrl("tcpq://127.0.0.1:7700").is_udpm);
}

TEST(DoctorTest, ATakenPortFailsAndAFreeOneDoesNot) {
  const Bound taken(SOCK_DGRAM);
  const Finding finding = checkPort("LiDAR port", taken.port);
  EXPECT_EQ(finding.level, Level::kFail);
  EXPECT_NE(finding.mend.find("ss -ulpn"), std::string::npos);
  EXPECT_EQ(checkPort("LiDAR port", freePort()).level, Level::kOk);
}

TEST(DoctorTest, ASensorIsHeardASilentOneMissedAnotherOneNamed) {
  EXPECT_EQ(checkSensor(freePort(), 0.05).level, Level::kWarn);
  for (const auto& [bytes, level] : {std::pair<size_t, Level>{1206, Level::kOk}, {512, Level::kFail}}) {
    const int port = freePort();
    std::jthread sender([port, size = bytes](const std::stop_token& stop) {
      const Bound socket(SOCK_DGRAM);
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      to.sin_port = htons(static_cast<uint16_t>(port));
      const std::vector<char> datagram(size);
      while (!stop.stop_requested()) {
        sendto(socket.fd, datagram.data(), size, 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    const Finding finding = checkSensor(port, bytes == 1206 ? 5 : 0.3);
    EXPECT_EQ(finding.level, level) << finding.found;
  }
}

TEST(DoctorTest, ARobotAnswersOrDoesNot) {
  const Bound robot(SOCK_STREAM);
  EXPECT_EQ(checkRobot("127.0.0.1", robot.port).level, Level::kFail) << "nobody listens";
  ASSERT_EQ(listen(robot.fd, 1), 0);
  EXPECT_EQ(checkRobot("127.0.0.1", robot.port).level, Level::kOk);
  EXPECT_EQ(checkRobot("no such robot").level, Level::kFail);
}

TEST(DoctorTest, BuffersAndTtl) {
  const std::string url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4000000";
  EXPECT_EQ(checkReceiveBuffer(url, 8'388'608).level, Level::kOk);
  const Finding stock = checkReceiveBuffer(url, 212'992);
  EXPECT_EQ(stock.level, Level::kWarn);
  EXPECT_NE(stock.mend.find("net.core.rmem_max"), std::string::npos);
  EXPECT_EQ(checkReceiveBuffer("udpm://239.255.76.67:7667", 8'388'608).level, Level::kWarn);
  EXPECT_EQ(checkTtl(url).level, Level::kOk);
  EXPECT_EQ(checkTtl("udpm://239.255.76.67:7667?ttl=8").level, Level::kWarn);
}

TEST(DoctorTest, AConfigurationThatIsWrongIsNamed) {
  DoctorOptions options;
  EXPECT_EQ(checkConfig(options).level, Level::kOk);
  options.assignments = {"backend.max_iteration=3"};
  const Finding finding = checkConfig(options);
  EXPECT_EQ(finding.level, Level::kFail);
  EXPECT_NE(finding.found.find("backend.max_iterations"), std::string::npos);
}

TEST(DoctorTest, FoldersAndPrograms) {
  const test::TempFolder folder;
  EXPECT_NE(checkFolder("output", folder / "a/b").level, Level::kFail);
  std::ofstream(folder / "file") << "x";
  EXPECT_EQ(checkFolder("output", folder / "file").level, Level::kFail);
  EXPECT_EQ(checkProgram("shell", "sh", Level::kFail, "").level, Level::kOk);
  EXPECT_EQ(checkProgram("x", "no-such-program", Level::kWarn, "get it").level, Level::kWarn);
}

TEST(DoctorTest, TextAndJsonTellTheSame) {
  const std::vector<Finding> findings{{"a", Level::kOk, "fine", ""}, {"b", Level::kFail, "bad", "mend it"}};
  EXPECT_FALSE(sound(findings));
  EXPECT_TRUE(sound({findings[0], {"c", Level::kWarn, "so so", "do"}}));
  EXPECT_EQ(toText(findings),
            "ok    a                  fine\n"
            "fail  b                  bad\n"
            "                         -> mend it\n");
  const auto json = nlohmann::json::parse(toJson(findings));
  EXPECT_EQ(json["ok"], false);
  EXPECT_EQ(json["checks"][1]["mend"], "mend it");
  EXPECT_EQ(json["checks"][1]["level"], "fail");
}

}  // namespace
}  // namespace sgraphs
