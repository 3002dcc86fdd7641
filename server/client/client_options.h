// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "ltm/core/time.h"

namespace engram::server {

/// How a client reaches servers.
struct ClientOptions {
  std::string token;  ///< Sent with each call; empty: no token is sent.
  /// PEM file of the certificate authority that signed the certificates of servers on other
  /// machines.
  std::filesystem::path ca;
  Duration timeout = std::chrono::seconds(10);  ///< For each call, retries included.
  /// Whether a call is retried until the timeout while the server cannot be reached; otherwise the
  /// call fails at once.
  bool tries_again = true;
  int max_message_bytes = 256 << 20;
  /// Whether large payloads go through shared memory when the server is reached by a Unix socket. A
  /// payload that a subscriber keeps occupies the server's shared memory until the subscriber frees
  /// it.
  bool shares_memory = true;
};

}  // namespace engram::server
