// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/crypto.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "ltm/core/status.h"

namespace engram::datasets::vault {

/// Overwrites memory before it is given back, so that no key stays in it.
template <typename T>
struct CleansingAllocator {
  using value_type = T;

  CleansingAllocator() = default;
  template <typename Other>
  CleansingAllocator(const CleansingAllocator<Other>& /*other*/) {}

  T* allocate(size_t count) { return std::allocator<T>().allocate(count); }
  void deallocate(T* items, size_t count) {
    OPENSSL_cleanse(items, count * sizeof(T));
    std::allocator<T>().deallocate(items, count);
  }

  friend bool operator==(const CleansingAllocator&, const CleansingAllocator&) = default;
};

/// Bytes that have keys in them.
using SecretBytes = std::vector<std::byte, CleansingAllocator<std::byte>>;

/// A key of AES-256, overwritten when it goes.
class SecretKey {
 public:
  static constexpr size_t kBytes = 32;

  SecretKey() = default;
  explicit SecretKey(std::span<const std::byte, kBytes> bytes) {
    std::copy(bytes.begin(), bytes.end(), bytes_.begin());
  }
  SecretKey(const SecretKey&) = default;
  SecretKey& operator=(const SecretKey&) = default;
  ~SecretKey() { OPENSSL_cleanse(bytes_.data(), bytes_.size()); }

  /// A key that nobody can guess. Errors: kUnavailable if the system has no randomness.
  static Result<SecretKey> random();

  [[nodiscard]] std::span<const std::byte, kBytes> bytes() const { return bytes_; }

 private:
  std::array<std::byte, kBytes> bytes_{};
};

/// Fills bytes that need not be secret, such as the name of a file.
/// Errors: kUnavailable if the system has no randomness.
Status fill_random(std::span<std::byte> bytes);

}  // namespace engram::datasets::vault
