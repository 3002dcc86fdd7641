// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/channel.h>

#include "memory/memory.h"
#include "server/client/client_options.h"
#include "server/client/shared_lane.h"

namespace engram::server {

/// Returns the current shared memory with the server, or null if there is none.
using LaneSource = std::function<std::shared_ptr<SharedLane>()>;

/// Opens a subscription at one server; see MemoryClient::subscribe.
Result<std::unique_ptr<Subscription>> subscribe_remotely(std::shared_ptr<grpc::Channel> channel,
                                                         const ClientOptions& client,
                                                         const SubscriptionOptions& options,
                                                         SubscriptionHandlers handlers,
                                                         LaneSource lane = {});

}  // namespace engram::server
