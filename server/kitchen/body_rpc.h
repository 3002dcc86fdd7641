// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/kitchen/live_body.h"
#include "server/access/endpoint.h"

namespace engram::server {

/// Lets drivers in other processes use a body (datasets/kitchen/robot_bus.h).
///
/// Whoever may write to the socket may move the robot: its owner and group.
/// Threading: one thread; calls are answered in threads of its own.
class BodyServer {
 public:
  /// Starts it. `body` must outlive it.
  /// Errors: kInvalidArgument if the endpoint is no Unix socket; those of RpcServer::start.
  static Result<std::unique_ptr<BodyServer>> start(datasets::kitchen::LiveBody& body,
                                                   const Endpoint& endpoint);
  /// Ends all calls.
  ~BodyServer();

 private:
  struct State;
  explicit BodyServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::server
