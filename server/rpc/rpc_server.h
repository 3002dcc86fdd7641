// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "server/access/listen_policy.h"

namespace engram::server {

/// Listens on the endpoints of one server and offers its services, with gRPC's health and
/// reflection services.
///
/// Owns: gRPC's threads.
/// Threading: one thread.
class RpcServer {
 public:
  struct Options {
    std::vector<Endpoint> endpoints;
    ListenPolicy::Options security;
    /// The max size of a message. A snapshot must fit into one.
    int max_message_bytes = 64 << 20;
    /// The max number of concurrent streams and calls of one connection.
    int max_streams_per_connection = 256;
  };

  /// Starts a server. `services` must outlive it. A socket file without a listener is replaced.
  /// Errors: those of ListenPolicy::check; kUnavailable if it cannot listen on an endpoint;
  /// kFailedPrecondition if another server listens there.
  static Result<std::unique_ptr<RpcServer>> start(const Options& options,
                                                  const std::vector<grpc::Service*>& services);
  /// Stops without grace.
  ~RpcServer();

  /// The endpoints it listens on, with the ports that the system chose.
  [[nodiscard]] std::vector<std::string> endpoints() const;

  /// Accepts no more calls, and ends the running ones after `grace`.
  void stop(Duration grace);

 private:
  struct State;
  explicit RpcServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
