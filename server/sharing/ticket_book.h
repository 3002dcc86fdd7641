// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/sharing/block_ref.h"

namespace engram::server {

/// The client that a ticket is for, and what it may read.
struct TicketHolder {
  ClientId client = kServerItself;
  std::vector<GroupId> readable;
};

/// The issued tickets that are still valid.
///
/// Threading: thread-safe.
/// Complexity: O(tickets); redeeming takes the same time for any ticket.
class TicketBook {
 public:
  TicketBook(Duration lifetime, size_t max) : lifetime_(lifetime), max_(max) {}

  /// Issues a new ticket. An earlier ticket of the same client becomes invalid.
  /// Errors: kResourceExhausted if too many tickets are valid; kUnavailable without random numbers.
  Result<Ticket> issue(TicketHolder holder, Time now);

  /// Returns the holder of a ticket, which is invalid afterwards; nothing if it is not valid.
  std::optional<TicketHolder> redeem(const Ticket& ticket, Time now);

 private:
  struct Issued {
    Ticket ticket;
    TicketHolder holder;
    Time expires;
  };

  const Duration lifetime_;
  const size_t max_;
  Mutex mutex_;
  std::vector<Issued> issued_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
