// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::server {

/// Limits of one registration.
struct RegistrationLimits {
  size_t memories = 128;
  size_t endpoints = 16;
  size_t text_bytes = 512;  ///< For each name and endpoint.

  /// Errors: kInvalidArgument if a limit is zero.
  [[nodiscard]] Status validate() const;
};

/// What a server reports about itself when it registers with the name system.
struct Registration {
  /// The server's name, which is the same after a restart, such as "vision-on-head".
  std::string server;
  /// The memories that it holds: first names of MemoryIds. Empty: it will report them later.
  std::vector<std::string> memories;
  /// Where it listens, best first: "unix:/run/engram/vision.sock", "host:50051".
  std::vector<std::string> endpoints;
  /// Larger after each restart of the server, such as its start time.
  uint64_t incarnation = 0;

  [[nodiscard]] bool holds(std::string_view memory) const;

  /// Errors: kInvalidArgument naming the server, if a text is empty, too long, not UTF-8 or given
  /// twice, if a text other than a memory's name has control characters, or if there is no endpoint
  /// or too many of anything.
  [[nodiscard]] Status check(const RegistrationLimits& limits) const;

  friend bool operator==(const Registration&, const Registration&) = default;
};

}  // namespace engram::server
