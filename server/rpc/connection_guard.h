// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

namespace engram::server {

/// Cuts off connections that open streams faster than anybody needs to, as those do that open and
/// reset them at once (HTTP/2 rapid reset, CVE-2023-44487). gRPC before 1.58 does not: each such
/// stream costs it some 20 kB for seconds, before any access is checked.
///
/// It reads gRPC's own counts of streams (channelz) 20 times a second. Streams that came to their
/// end count for nothing, so programs may call as often as they like. Of others a connection may
/// open kStreamsPerSecond, those of a second at once; what opens more is shut down, and its memory
/// is given back. Of connections to a Unix socket, which gRPC does not tell apart, the one with the
/// most unread bytes is shut down.
///
/// Owns: one thread, which looks at all servers of the process.
/// Threading: thread-safe.
/// Source: docs/access.md, section "Clients that mean harm".
class ConnectionGuard {
 public:
  static constexpr int64_t kStreamsPerSecond = 1000;

  /// The guard of this process. It works as long as anybody holds it.
  static std::shared_ptr<ConnectionGuard> of_process();
  ~ConnectionGuard();
  ConnectionGuard(const ConnectionGuard&) = delete;
  ConnectionGuard& operator=(const ConnectionGuard&) = delete;

  /// Number of connections that were cut off.
  [[nodiscard]] uint64_t cut() const;

 private:
  struct State;
  ConnectionGuard();

  std::unique_ptr<State> state_;
};

}  // namespace engram::server
