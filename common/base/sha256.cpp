#include "common/base/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <bit>
#include <fstream>
#include <vector>

#include "common/base/error.h"

namespace sgraphs {

static_assert(std::endian::native == std::endian::little, "digests are defined on little-endian bytes");

struct Sha256::Context {
  EVP_MD_CTX* md = EVP_MD_CTX_new();
  ~Context() { EVP_MD_CTX_free(md); }
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  EVP_DigestInit_ex(context_->md, EVP_sha256(), nullptr);
}
Sha256::~Sha256() = default;

void Sha256::addBytes(std::span<const uint8_t> bytes) {
  EVP_DigestUpdate(context_->md, bytes.data(), bytes.size());
}
void Sha256::add(int64_t value) {
  EVP_DigestUpdate(context_->md, &value, sizeof value);
}
void Sha256::add(double value) {
  EVP_DigestUpdate(context_->md, &value, sizeof value);
}
void Sha256::add(std::string_view text) {
  add(static_cast<int64_t>(text.size()));
  EVP_DigestUpdate(context_->md, text.data(), text.size());
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_DigestFinal_ex(context_->md, digest.data(), &size);
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 15];
  }
  return text;
}

std::string sha256OfFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("cannot read '" + path + "': check the path and its permissions");
  Sha256 sha;
  std::vector<char> buffer(1 << 20);
  while (in) {
    in.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    sha.addBytes({reinterpret_cast<const uint8_t*>(buffer.data()), static_cast<size_t>(in.gcount())});
  }
  return sha.hex();
}

}  // namespace sgraphs
