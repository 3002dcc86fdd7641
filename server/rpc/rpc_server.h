// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "server/access/listen_policy.h"

namespace engram::server {

/// Listens for what one process serves, with health and reflection services beside it.
///
/// Owns: gRPC's threads.
/// Threading: one thread.
class RpcServer {
 public:
  struct Options {
    std::vector<Endpoint> endpoints;
    ListenPolicy::Options security;
    /// Longest message. A snapshot has to fit into one.
    int max_message_bytes = 64 << 20;
    /// Streams and calls of one connection at a time.
    int max_streams_per_connection = 256;
  };

  /// `services` outlive it. A socket file that nobody listens on any more is replaced.
  /// Errors: those of ListenPolicy::check; kUnavailable where an endpoint cannot be listened on;
  /// kFailedPrecondition where another server listens there.
  static Result<std::unique_ptr<RpcServer>> start(const Options& options,
                                                  const std::vector<grpc::Service*>& services);
  /// Stops at once.
  ~RpcServer();

  /// Where it listens, with the ports that the system chose.
  [[nodiscard]] std::vector<std::string> endpoints() const;

  /// Takes no more calls, and ends those there are after `grace`.
  void stop(Duration grace);

 private:
  struct State;
  explicit RpcServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
