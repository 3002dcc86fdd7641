// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "datasets/kitchen/body_steps.h"
#include "datasets/kitchen/robot_bus.h"
#include "server/access/endpoint.h"

namespace engram::server {

/// Returns the bus to the body that a BodyServer offers at an endpoint, for a client of this name.
/// Does not wait for the server; calls fail with kUnavailable if it is not there.
/// Errors: kInvalidArgument if the endpoint is no Unix socket.
Result<std::unique_ptr<datasets::kitchen::RobotBus>> connect_body(const Endpoint& endpoint,
                                                                  const std::string& client);

/// Returns the steps of that body, for its driver of skills. Errors: those of connect_body.
Result<std::unique_ptr<datasets::kitchen::BodySteps>> connect_steps(const Endpoint& endpoint);

}  // namespace engram::server
