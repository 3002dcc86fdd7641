// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::server {

/// Where a server listens, or where clients reach it.
///
///     unix:/run/engram/vision.sock
///     head.local:50051
///     10.0.0.7:50051
///     [fe80::1]:50051
///
/// The first is a socket in the file system: an absolute path of 107 bytes at most. The others are
/// a host, by name or address, and a port.
/// Threading: immutable except by assignment.
class Endpoint {
 public:
  enum class Kind : uint8_t { kUnix, kTcp };

  /// Parses an endpoint. Port 0 is for listening: the system chooses a port.
  /// Errors: kInvalidArgument naming the text, what was found and what was needed.
  static Result<Endpoint> parse(std::string_view text);

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] const std::string& path() const { return place_; }  ///< For kUnix.
  [[nodiscard]] const std::string& host() const { return place_; }  ///< For kTcp, without brackets.
  [[nodiscard]] uint16_t port() const { return port_; }             ///< For kTcp.

  /// Whether only this machine can reach it: a Unix socket, 127.0.0.0/8, ::1 or `localhost`.
  [[nodiscard]] bool is_local() const;

  /// Returns the text that parse() reads back to an equal endpoint.
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const Endpoint&, const Endpoint&) = default;

 private:
  Endpoint(Kind kind, std::string place, uint16_t port)
      : kind_(kind), place_(std::move(place)), port_(port) {}

  Kind kind_;
  std::string place_;
  uint16_t port_ = 0;
};

}  // namespace engram::server
