#include "tools/simulate/scene/plan_override.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.h"

namespace sgraphs::simulate {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

json plan() {
  return json::parse(R"({"walls": [{"thickness": 0.1}, {"thickness": 0.2}], "path": {"speed_mps": 1}})");
}

json changed(const std::string& assignment) {
  json p = plan();
  overridePlan(p, assignment);
  return p;
}

std::string overrideComplaint(const std::string& assignment) {
  try {
    changed(assignment);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(PlanOverrideTest, ValuesAreJsonOrElseText) {
  EXPECT_EQ(changed("path.speed_mps=0.5")["path"]["speed_mps"], 0.5);
  EXPECT_EQ(changed("floors=[0, 3]")["floors"], json({0, 3}));
  EXPECT_EQ(changed("scene=a house=b")["scene"], "a house=b");
  EXPECT_EQ(changed("faults.silences=[{\"begin_s\":1}]")["faults"]["silences"][0]["begin_s"], 1);
}

TEST(PlanOverrideTest, ItemsOfListsAreNumbered) {
  const json p = changed("walls.1.thickness=0.3");
  EXPECT_EQ(p["walls"][0]["thickness"], 0.1);
  EXPECT_EQ(p["walls"][1]["thickness"], 0.3);
}

TEST(PlanOverrideTest, ObjectsOnTheWayAreMade) {
  EXPECT_EQ(changed("sensor.range_sigma_m=0.03")["sensor"]["range_sigma_m"], 0.03);
}

TEST(PlanOverrideTest, WrongPathsAreNamedInOneLine) {
  EXPECT_THAT(overrideComplaint("walls.2.thickness=1"),
              AllOf(HasSubstr("--set walls.2"), HasSubstr("holds 2 items")));
  EXPECT_THAT(overrideComplaint("walls.first=1"), HasSubstr("'walls' is a list"));
  EXPECT_THAT(overrideComplaint("walls.-1=1"), HasSubstr("'walls' is a list"));
  EXPECT_THAT(overrideComplaint("path.speed_mps.x=1"), HasSubstr("'path.speed_mps' is a single value"));
  EXPECT_THAT(overrideComplaint("wals.0=1"), HasSubstr("no 'wals'"));
  EXPECT_THAT(overrideComplaint("path..speed=1"), HasSubstr("key=value"));
  EXPECT_THAT(overrideComplaint("path.speed_mps"), HasSubstr("key=value"));
  EXPECT_THAT(overrideComplaint("=1"), HasSubstr("key=value"));
}

}  // namespace
}  // namespace sgraphs::simulate
