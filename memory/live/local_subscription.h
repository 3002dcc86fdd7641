// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

#include "memory/live/event_hub.h"
#include "memory/live/subscription.h"

namespace engram::memory {

/// Subscribes to what is published at `hub`; the handlers are called by a thread of the
/// subscription. It shares the hub, so a subscription may outlive its memory and is told nothing
/// more afterwards. `begin` is called once it is in place: however much is published meanwhile, the
/// subscription is told of it.
/// Errors: those of subscribed_names().
Result<std::unique_ptr<Subscription>> subscribe_locally(std::shared_ptr<EventHub> hub,
                                                        const SubscriptionOptions& options,
                                                        SubscriptionHandlers handlers,
                                                        const std::function<void()>& begin = {});

}  // namespace engram::memory
