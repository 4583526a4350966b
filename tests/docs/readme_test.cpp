#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/channels.h"

// What the README and docs/ say about the sources stays true.
namespace sgraphs {
namespace {

namespace fs = std::filesystem;

std::string readSource(const fs::path& path) {
  std::ifstream in(fs::path(SGRAPHS_SOURCE_DIR) / path);
  EXPECT_TRUE(in.good()) << path;
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string channelTable() {
  std::string text =
      "| channel | type | written by | rate | raw |\n"
      "|---|---|---|---|---|\n";
  for (const channels::Row& row : channels::table())
    text += std::string("| `") + row.name + "` | `" + row.type + "` | " + row.writer + " | " + row.rate +
            " | " + (row.raw ? "yes" : "") + " |\n";
  return text;
}

// Expression for `lcm-logplayer -e`.
std::string rawChannels() {
  std::string text;
  for (const channels::Row& row : channels::table())
    if (row.raw) text += (text.empty() ? "" : "|") + std::string(row.name);
  return text;
}

TEST(ReadmeTest, ShowsTheTableOfChannels) {
  const std::string readme = readSource("README.md");
  EXPECT_NE(readme.find("\n" + channelTable() + "\n"), std::string::npos)
      << "README.md should hold these rows:\n"
      << channelTable();
}

TEST(ReadmeTest, PlaysExactlyTheRawChannels) {
  for (const char* file : {"README.md", "docs/messages.md", "tests/integration/play_log.sh"})
    EXPECT_NE(readSource(file).find("'" + rawChannels() + "'"), std::string::npos)
        << file << " should hold '" << rawChannels() << "'";
}

TEST(ReadmeTest, MessagesExplainsEveryChannelAndType) {
  const std::string messages = readSource("docs/messages.md");
  for (const channels::Row& row : channels::table())
    EXPECT_NE(messages.find(std::string("`") + row.name + "`"), std::string::npos) << row.name;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(SGRAPHS_SOURCE_DIR) / "lcmtypes")) {
    if (entry.path().extension() != ".lcm") continue;
    const std::string type = entry.path().stem().string();
    EXPECT_NE(messages.find("`" + type + "`"), std::string::npos) << type;
  }
}

TEST(ReadmeTest, LinksLeadToFiles) {
  std::vector<fs::path> pages{"README.md", "THIRD_PARTY_NOTICES.md", "config/README.md",
                              "config/scenes/README.md"};
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(SGRAPHS_SOURCE_DIR) / "docs"))
    if (entry.path().extension() == ".md") pages.push_back(fs::path("docs") / entry.path().filename());
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  int links = 0;
  for (const fs::path& page : pages) {
    const std::string text = readSource(page);
    for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match, ++links)
      EXPECT_TRUE(fs::exists(fs::path(SGRAPHS_SOURCE_DIR) / page.parent_path() / (*match)[1].str()))
          << page << " links to " << (*match)[1];
  }
  EXPECT_GT(links, 0);
}

}  // namespace
}  // namespace sgraphs
