#pragma once

#include <string>

namespace sgraphs {

// Who logs in at the robot. Neither stands in a configuration, on a command line or in a log.
struct Credentials {
  std::string user;
  std::string password;
};

// From the file, in the form of an environment file (SGRAPHS_SPOT_USER=…, SGRAPHS_SPOT_PASSWORD=…, one per
// line, '#' comments), or from the variables of these names if `file` is empty. Throws UsageError if one of
// the two is missing, and if the file is not a regular file that belongs to this user and that nobody else
// can read or write.
Credentials readCredentials(const std::string& file);

// The text without what is secret, for logs.
std::string withoutSecrets(std::string text, const Credentials& credentials, const std::string& token);

}  // namespace sgraphs
