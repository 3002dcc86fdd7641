// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/channel.h>

#include "server/client/memory_client.h"

namespace engram::server {

/// See MemoryClient::subscribe.
Result<std::unique_ptr<Subscription>> subscribe_remotely(std::shared_ptr<grpc::Channel> channel,
                                                         const ClientOptions& client,
                                                         const SubscriptionOptions& options,
                                                         SubscriptionHandlers handlers);

}  // namespace engram::server
