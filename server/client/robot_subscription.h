// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "server/client/robot_servers.h"

namespace engram::server {

/// Opens a subscription at all servers of a robot; see RobotMemory::subscribe. `owner` keeps
/// `servers` alive as long as the subscription lives.
Result<std::unique_ptr<Subscription>> subscribe_to_robot(RobotServers& servers,
                                                         std::shared_ptr<void> owner,
                                                         const SubscriptionOptions& options,
                                                         SubscriptionHandlers handlers);

}  // namespace engram::server
