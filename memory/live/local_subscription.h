// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "memory/live/event_hub.h"
#include "memory/live/subscription.h"

namespace engram::memory {

/// Tells of what is published at `hub`, which outlives it, by a thread of its own.
/// Errors: those of subscribed_names().
Result<std::unique_ptr<Subscription>> subscribe_locally(EventHub& hub,
                                                        const SubscriptionOptions& options,
                                                        SubscriptionHandlers handlers);

}  // namespace engram::memory
