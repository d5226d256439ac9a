// SPDX-License-Identifier: Apache-2.0
#include "formats/files/sha256.hpp"

#include <fcntl.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include "formats/files/text_file.hpp"

namespace spm {
namespace {

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) {
      throw std::bad_alloc();
    }
  }

  void add(const void* data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }

  std::string hex() {
    std::array<unsigned char, 32> digest{};
    unsigned int length = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &length);
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const unsigned char byte : digest) {
      text += digits[byte >> 4U];
      text += digits[byte & 15U];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string sha256_bytes(std::span<const std::byte> bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256_bytes(std::string_view bytes) {
  return sha256_bytes(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

Result<std::string> sha256_file(const std::string& path) {
  if (is_special_file(path)) {
    return fail(ExitCode::file_or_device,
                path + ": is a device or a pipe, which may never end; give a file");
  }
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return fail(ExitCode::file_or_device, path + ": cannot be opened: " + std::strerror(errno) +
                                              "; check the path and its permissions");
  }
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20U);
  ssize_t count = 0;
  while ((count = ::read(file, buffer.data(), buffer.size())) != 0) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int cause = errno;
      ::close(file);
      return fail(ExitCode::file_or_device,
                  path + ": cannot be read: " + std::strerror(cause) + "; give a readable file");
    }
    hash.add(buffer.data(), static_cast<std::size_t>(count));
  }
  ::close(file);
  return hash.hex();
}

}  // namespace spm
