#pragma once

#include <string>
#include <vector>

namespace sgraphs::test {

// A certificate that signed itself, and its key; PEM.
struct FakeCertificate {
  std::string certificate_pem;
  std::string key_pem;
};

// Made anew, valid for a day, for servers of these names.
FakeCertificate makeCertificate(const std::vector<std::string>& names);

}  // namespace sgraphs::test
