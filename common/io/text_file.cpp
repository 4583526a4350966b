#include "common/io/text_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/base/error.h"

namespace sgraphs {

std::string readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  // An empty file inserts nothing, which sets the fail bit of the destination: only `in` is judged.
  if (!in || std::filesystem::is_directory(path)) throw Error("cannot read '" + path + "': check the path");
  bytes << in.rdbuf();
  if (in.bad()) throw Error("cannot read '" + path + "': the disk reports an error");
  return bytes.str();
}

void writeFile(const std::string& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  if (!out) throw Error("cannot write '" + path + "': check the folder and its permissions");
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw Error("cannot write '" + path + "': is the disk full?");
}

void createFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path))
    throw Error("cannot create folder '" + path + "': check the path and its permissions");
}

}  // namespace sgraphs
