#include "common/io/text_file.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "common/base/error.h"
#include "tests/support/temp_folder.h"

namespace sgraphs {
namespace {

TEST(TextFileTest, EveryByteSurvives) {
  const test::TempFolder folder;
  const std::string path = folder / "file", bytes("a\r\n\0\xFFz", 6);
  writeFile(path, bytes);
  EXPECT_EQ(readFile(path), bytes);
  writeFile(path, "");
  EXPECT_EQ(readFile(path), "");
}

TEST(TextFileTest, WhatCannotBeReadOrWrittenIsNamed) {
  const test::TempFolder folder;
  const std::string nowhere = folder / "no_such_folder/file";
  EXPECT_THROW(readFile(nowhere), Error);
  EXPECT_THROW(readFile(folder.path()), Error);
  try {
    writeFile(nowhere, "x");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(nowhere));
  }
}

TEST(TextFileTest, FoldersAreCreatedWithTheirParents) {
  const test::TempFolder folder;
  const std::string& top = folder.path();
  createFolder(top + "/a/b");
  createFolder(top + "/a/b");
  EXPECT_TRUE(std::filesystem::is_directory(top + "/a/b"));
}

}  // namespace
}  // namespace sgraphs
