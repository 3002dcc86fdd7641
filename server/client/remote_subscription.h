// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/channel.h>

#include "server/client/memory_client.h"
#include "server/client/shared_lane.h"

namespace engram::server {

/// Shared memory with the server, as it is now; null where there is none.
using LaneSource = std::function<std::shared_ptr<SharedLane>()>;

/// See MemoryClient::subscribe.
Result<std::unique_ptr<Subscription>> subscribe_remotely(std::shared_ptr<grpc::Channel> channel,
                                                         const ClientOptions& client,
                                                         const SubscriptionOptions& options,
                                                         SubscriptionHandlers handlers,
                                                         LaneSource lane = {});

}  // namespace engram::server
