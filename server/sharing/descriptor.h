// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "ltm/core/status.h"

namespace engram::server {

/// A file descriptor that is closed with this object; negative if there is none.
///
/// Threading: one thread.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }

 private:
  int fd_ = -1;
};

/// Converts errno to kResourceExhausted if memory or descriptors are used up, else to kUnavailable.
[[nodiscard]] inline Status system_status(std::string_view what) {
  const int error = errno;
  const bool is_exhausted =
      error == ENOMEM || error == ENOSPC || error == EMFILE || error == ENFILE;
  return {is_exhausted ? StatusCode::kResourceExhausted : StatusCode::kUnavailable,
          fmt::format("{}: {}", what, std::generic_category().message(error))};
}

}  // namespace engram::server
