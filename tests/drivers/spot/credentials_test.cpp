#include "drivers/spot/credentials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>

#include "common/base/error.h"
#include "common/io/text_file.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class CredentialsTest : public ::testing::Test {
 protected:
  CredentialsTest() {
    unsetenv("SGRAPHS_SPOT_USER");
    unsetenv("SGRAPHS_SPOT_PASSWORD");
  }
  std::string file(const std::string& text, mode_t mode) {
    std::string path = folder_ / "spot.env";
    writeFile(path, text);
    chmod(path.c_str(), mode);
    return path;
  }
  static std::string errorOf(const std::string& path) {
    try {
      readCredentials(path);
    } catch (const UsageError& e) {
      return e.what();
    }
    return "none";
  }
  test::TempFolder folder_;
};

TEST_F(CredentialsTest, ComeFromTheEnvironment) {
  EXPECT_EQ(errorOf(""), "SGRAPHS_SPOT_USER is not set: set it, or give --credentials FILE");
  setenv("SGRAPHS_SPOT_USER", "walker", 1);
  EXPECT_THAT(errorOf(""), HasSubstr("SGRAPHS_SPOT_PASSWORD is not set"));
  setenv("SGRAPHS_SPOT_PASSWORD", "tick=tock", 1);
  EXPECT_EQ(readCredentials("").user, "walker");
  EXPECT_EQ(readCredentials("").password, "tick=tock");
}

TEST_F(CredentialsTest, ComeFromAPrivateFile) {
  const std::string path =
      file("# robot 7\nSGRAPHS_SPOT_USER=walker\r\nSGRAPHS_SPOT_PASSWORD=\"a = b#c\"\n\nOTHER=x\n", 0600);
  EXPECT_EQ(readCredentials(path).user, "walker");
  EXPECT_EQ(readCredentials(path).password, "a = b#c");
}

TEST_F(CredentialsTest, AFileThatOthersMayReadOrWriteIsRefused) {
  const std::string text = "SGRAPHS_SPOT_USER=walker\nSGRAPHS_SPOT_PASSWORD=tock\n";
  for (const mode_t mode : {0640, 0604, 0620, 0666}) {
    const std::string error = errorOf(file(text, mode));
    EXPECT_THAT(error, HasSubstr("can be read or written by others: chmod 600"));
    EXPECT_THAT(error, Not(HasSubstr("tock")));
  }
  EXPECT_EQ(errorOf(file(text, 0400)), "none");
}

TEST_F(CredentialsTest, WhatIsNoFileOrHoldsTooLittleIsNamed) {
  EXPECT_THAT(errorOf(folder_ / "absent"), HasSubstr("absent': check the path"));
  EXPECT_THAT(errorOf(folder_.path()), HasSubstr("is not a regular file"));
  EXPECT_THAT(errorOf(file("SGRAPHS_SPOT_USER=walker\n", 0600)),
              HasSubstr("holds no line SGRAPHS_SPOT_PASSWORD=…"));
}

TEST(SecretsTest, AreTakenOutOfTexts) {
  EXPECT_EQ(withoutSecrets("bad pw and tok, pw", {"walker", "pw"}, "tok"), "bad *** and ***, ***");
  EXPECT_EQ(withoutSecrets("nothing", {"walker", "pw"}, ""), "nothing");
  EXPECT_EQ(withoutSecrets("****", {"walker", "*"}, ""), "************");
}

}  // namespace
}  // namespace sgraphs
