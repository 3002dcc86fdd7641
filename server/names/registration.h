// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::server {

/// What one server may say of itself.
struct RegistrationLimits {
  size_t memories = 128;
  size_t endpoints = 16;
  size_t text_bytes = 512;  ///< Of each name and endpoint.

  /// Errors: kInvalidArgument where one is zero.
  [[nodiscard]] Status validate() const;
};

/// What a server says of itself when it registers with the name system.
struct Registration {
  /// Its name, which it keeps over restarts: "vision-on-head".
  std::string server;
  /// Those that it holds: first names of MemoryIds. None: it will say so later.
  std::vector<std::string> memories;
  /// Where it listens, the best first: "unix:/run/engram/vision.sock", "host:50051".
  std::vector<std::string> endpoints;
  /// Larger after each restart of the server; the time when it started will do.
  uint64_t incarnation = 0;

  [[nodiscard]] bool holds(std::string_view memory) const;

  /// Errors: kInvalidArgument naming the server: a text is empty, too long, no UTF-8 or has control
  /// characters (memories may), is there twice, there is no endpoint, or there are too many.
  [[nodiscard]] Status check(const RegistrationLimits& limits) const;

  friend bool operator==(const Registration&, const Registration&) = default;
};

}  // namespace engram::server
