#include "drivers/spot/credentials.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <map>
#include <sstream>

#include "common/base/error.h"

namespace sgraphs {
namespace {

constexpr const char* kUser = "SGRAPHS_SPOT_USER";
constexpr const char* kPassword = "SGRAPHS_SPOT_PASSWORD";
constexpr size_t kMaxFileBytes = 4096;

class File {
 public:
  explicit File(const std::string& path)
      : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~File() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

// Checked on the open file, so that what is read is what was checked.
std::string readPrivateFile(const std::string& path) {
  const File file(path);
  if (file.descriptor() < 0)
    throw UsageError("cannot read the credentials file '" + path + "': check the path");
  struct stat info {};
  if (fstat(file.descriptor(), &info) != 0 || !S_ISREG(info.st_mode))
    throw UsageError("the credentials file '" + path + "' is not a regular file");
  if (info.st_uid != geteuid())
    throw UsageError("the credentials file '" + path + "' belongs to another user: it must be your own");
  if (info.st_mode & (S_IRWXG | S_IRWXO))
    throw UsageError("the credentials file '" + path + "' can be read or written by others: chmod 600 '" +
                     path + "'");
  std::string text(kMaxFileBytes, '\0');
  const ssize_t bytes = read(file.descriptor(), text.data(), text.size());
  text.resize(bytes > 0 ? static_cast<size_t>(bytes) : 0);
  return text;
}

std::map<std::string, std::string> assignmentsIn(const std::string& text) {
  std::map<std::string, std::string> values;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const size_t equals = line.find('=');
    if (line.empty() || line.front() == '#' || equals == std::string::npos) continue;
    std::string value = line.substr(equals + 1);
    if (value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front())
      value = value.substr(1, value.size() - 2);
    values[line.substr(0, equals)] = value;
  }
  return values;
}

void replaceAll(std::string& text, const std::string& secret) {
  if (secret.empty()) return;
  for (size_t at = text.find(secret); at != std::string::npos; at = text.find(secret, at + 3))
    text.replace(at, secret.size(), "***");
}

}  // namespace

Credentials readCredentials(const std::string& file) {
  std::map<std::string, std::string> values;
  if (!file.empty()) {
    values = assignmentsIn(readPrivateFile(file));
  } else {
    for (const char* name : {kUser, kPassword})
      if (const char* value = std::getenv(name)) values[name] = value;
  }
  for (const char* name : {kUser, kPassword})
    if (values[name].empty())
      throw UsageError(file.empty() ? std::string(name) + " is not set: set it, or give --credentials FILE"
                                    : "the credentials file '" + file + "' holds no line " + name + "=…");
  return {values[kUser], values[kPassword]};
}

std::string withoutSecrets(std::string text, const Credentials& credentials, const std::string& token) {
  replaceAll(text, token);
  replaceAll(text, credentials.password);
  return text;
}

}  // namespace sgraphs
