#include "common/config/config_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"
#include "tests/common/test_files.h"

namespace sgraphs {
namespace {

using testing::HasSubstr;

struct Filter {
  double voxel_m = 0.1;
  int passes = 2;
  void visit(ConfigVisitor& v) {
    v.field("voxel_m", voxel_m, 0.01, 1.0, "Edge of a voxel [m]");
    v.field("passes", passes, 1, 5, "Number of passes");
  }
};

struct Config {
  bool verbose = false;
  std::string mode = "fast";
  Filter filter;
  void visit(ConfigVisitor& v) {
    v.field("verbose", verbose, "Say more");
    v.field("mode", mode, {"fast", "exact"}, "How to work");
    v.section("filter", filter, "Thinning of scans");
  }
};

std::string load(Config& config, const std::string& yaml) {
  const auto path = test::freshFolder() / "config.yaml";
  test::writeText(path, yaml);
  loadConfigFile(visitOf(config), path);
  return path;
}

std::string loadError(const std::string& yaml) {
  Config config;
  return test::messageOf<UsageError>([&] { load(config, yaml); });
}

TEST(ConfigIoTest, AFileOverridesWhatItNames) {
  Config config;
  load(config, "mode: exact\nfilter:\n  voxel_m: 0.25\n");
  EXPECT_EQ(config.mode, "exact");
  EXPECT_EQ(config.filter.voxel_m, 0.25);
  EXPECT_EQ(config.filter.passes, 2);
  EXPECT_FALSE(config.verbose);
}

TEST(ConfigIoTest, AnEmptyFileLeavesTheDefaults) {
  Config config;
  load(config, "# nothing but a comment\n");
  EXPECT_EQ(configToYaml(visitOf(config)), [] {
    Config defaults;
    return configToYaml(visitOf(defaults));
  }());
}

TEST(ConfigIoTest, AnUnknownKeyNamesTheNearestOne) {
  const std::string message = loadError("filter:\n  voxl_m: 0.2\n");
  EXPECT_THAT(message, HasSubstr("unknown key 'filter.voxl_m'"));
  EXPECT_THAT(message, HasSubstr("'filter.voxel_m'"));
  EXPECT_THAT(message, HasSubstr("config.yaml"));
}

TEST(ConfigIoTest, ValuesOutsideTheirRangeAreRefusedWithTheRange) {
  EXPECT_THAT(loadError("filter:\n  voxel_m: 2.0\n"), HasSubstr("[0.01, 1]"));
  EXPECT_THAT(loadError("filter:\n  voxel_m: nan\n"), HasSubstr("filter.voxel_m"));
  EXPECT_THAT(loadError("filter:\n  passes: 0\n"), HasSubstr("[1, 5]"));
  EXPECT_THAT(loadError("mode: slow\n"), HasSubstr("fast, exact"));
}

TEST(ConfigIoTest, TheEndsOfARangeBelongToIt) {
  Config config;
  load(config, "filter: {voxel_m: 0.01, passes: 5}\n");
  EXPECT_EQ(config.filter.voxel_m, 0.01);
  EXPECT_EQ(config.filter.passes, 5);
}

TEST(ConfigIoTest, WrongKindsOfValuesAreRefused) {
  EXPECT_THAT(loadError("filter:\n  passes: 2.5\n"), HasSubstr("is not a number"));
  EXPECT_THAT(loadError("filter:\n  passes: many\n"), HasSubstr("is not a number"));
  EXPECT_THAT(loadError("verbose: 7\n"), HasSubstr("true or false"));
  EXPECT_THAT(loadError("mode: [fast, exact]\n"), HasSubstr("single value"));
  EXPECT_THAT(loadError("just a word\n"), HasSubstr("mapping"));
  EXPECT_THAT(loadError("mode: fast\n  : :\n"), HasSubstr("line "));
}

TEST(ConfigIoTest, AMissingFileIsNamed) {
  Config config;
  EXPECT_THAT(test::messageOf<UsageError>([&] { loadConfigFile(visitOf(config), "/no/such.yaml"); }),
              HasSubstr("/no/such.yaml"));
}

TEST(ConfigIoTest, YamlRoundTripKeepsEveryValueExactly) {
  Config config;
  config.verbose = true;
  config.mode = "exact";
  config.filter = {0.1 + 0.2, 4};
  Config read;
  load(read, configToYaml(visitOf(config)));
  EXPECT_TRUE(read.verbose);
  EXPECT_EQ(read.mode, "exact");
  EXPECT_EQ(read.filter.voxel_m, 0.1 + 0.2);
  EXPECT_EQ(read.filter.passes, 4);
  EXPECT_EQ(configDigest(visitOf(read)), configDigest(visitOf(config)));
}

TEST(ConfigIoTest, YamlDocumentsEveryKey) {
  Config config;
  const std::string yaml = configToYaml(visitOf(config));
  EXPECT_THAT(yaml, HasSubstr("# Edge of a voxel [m]; 0.01 to 1\n  voxel_m: 0.1\n"));
  EXPECT_THAT(yaml, HasSubstr("# How to work; one of fast, exact"));
}

TEST(ConfigIoTest, AssignmentsGoByDottedKey) {
  Config config;
  setConfigValue(visitOf(config), "filter.passes=3");
  setConfigValue(visitOf(config), "verbose=true");
  EXPECT_EQ(config.filter.passes, 3);
  EXPECT_TRUE(config.verbose);
  const auto error = [&](const std::string& text) {
    return test::messageOf<UsageError>([&] { setConfigValue(visitOf(config), text); });
  };
  EXPECT_THAT(error("filter.pases=3"), HasSubstr("'filter.passes'"));
  EXPECT_THAT(error("filter.passes"), HasSubstr("section.key=value"));
  EXPECT_THAT(error("=3"), HasSubstr("section.key=value"));
  EXPECT_THAT(error("filter.passes=9"), HasSubstr("[1, 5]"));
}

TEST(ConfigIoTest, TheDigestChangesWithAnyValue) {
  Config config;
  const std::string before = configDigest(visitOf(config));
  config.filter.voxel_m = std::nextafter(config.filter.voxel_m, 1.0);
  EXPECT_NE(configDigest(visitOf(config)), before);
}

}  // namespace
}  // namespace sgraphs
