// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace engram {

/// Immutable bytes with a shared owner: copying is O(1), and a slice keeps all bytes alive.
///
/// Threading: immutable.
class Buffer {
 public:
  Buffer() = default;

  /// Views `bytes`, which must stay valid as long as `owner` lives.
  Buffer(std::shared_ptr<const void> owner, std::span<const std::byte> bytes)
      : owner_(std::move(owner)), bytes_(bytes) {}

  /// Takes the bytes of a vector of trivially copyable elements without copying them.
  template <typename T>
  static Buffer take(std::vector<T> values) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    auto owner = std::make_shared<const std::vector<T>>(std::move(values));
    const auto bytes = std::as_bytes(std::span(*owner));
    return Buffer(std::move(owner), bytes);
  }

  static Buffer copy(std::span<const std::byte> bytes) {
    return take(std::vector<std::byte>(bytes.begin(), bytes.end()));
  }

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  [[nodiscard]] const std::byte* data() const { return bytes_.data(); }
  [[nodiscard]] size_t size() const { return bytes_.size(); }
  [[nodiscard]] bool empty() const { return bytes_.empty(); }

  /// A part of the bytes with the same owner. Needs offset + count <= size().
  [[nodiscard]] Buffer slice(size_t offset, size_t count) const {
    return Buffer(owner_, bytes_.subspan(offset, count));
  }

  [[nodiscard]] const std::shared_ptr<const void>& owner() const { return owner_; }

 private:
  std::shared_ptr<const void> owner_;
  std::span<const std::byte> bytes_;
};

[[nodiscard]] inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[nodiscard]] inline std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace engram
