// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "memory/live/event_hub.h"
#include "memory/live/subscription.h"

namespace engram::memory {

/// Tells of what is published at `hub`, by a thread of its own. The hub lives as long as this: a
/// subscription may outlive the memory that it is of, and is told nothing more then.
/// Errors: those of subscribed_names().
Result<std::unique_ptr<Subscription>> subscribe_locally(std::shared_ptr<EventHub> hub,
                                                        const SubscriptionOptions& options,
                                                        SubscriptionHandlers handlers);

}  // namespace engram::memory
