#include "common/io/text_file.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "common/base/error.h"

namespace sgraphs {
namespace {

TEST(TextFileTest, EveryByteSurvives) {
  const std::string path = testing::TempDir() + "sgraphs_text_file", bytes("a\r\n\0\xFFz", 6);
  writeFile(path, bytes);
  EXPECT_EQ(readFile(path), bytes);
  writeFile(path, "");
  EXPECT_EQ(readFile(path), "");
}

TEST(TextFileTest, WhatCannotBeReadOrWrittenIsNamed) {
  const std::string nowhere = testing::TempDir() + "sgraphs_no_such_folder/file";
  EXPECT_THROW(readFile(nowhere), Error);
  EXPECT_THROW(readFile(testing::TempDir()), Error);
  try {
    writeFile(nowhere, "x");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(nowhere));
  }
}

TEST(TextFileTest, FoldersAreCreatedWithTheirParents) {
  const std::string top = testing::TempDir() + "sgraphs_folders";
  std::filesystem::remove_all(top);
  createFolder(top + "/a/b");
  createFolder(top + "/a/b");
  EXPECT_TRUE(std::filesystem::is_directory(top + "/a/b"));
}

}  // namespace
}  // namespace sgraphs
