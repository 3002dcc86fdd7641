// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "server/sharing/block_ref.h"

namespace engram::server {

/// Who a ticket is for, and what it may read.
struct TicketHolder {
  ClientId client = kServerItself;
  std::vector<GroupId> readable;
};

/// The tickets that were issued and are still good.
///
/// Threading: thread-safe. Complexity: O(tickets); redeeming takes as long whichever it is.
class TicketBook {
 public:
  TicketBook(Duration lifetime, size_t max) : lifetime_(lifetime), max_(max) {}

  /// A new one. An earlier one of the same client is good no more.
  /// Errors: kResourceExhausted where too many are good, kUnavailable without random numbers.
  Result<Ticket> issue(TicketHolder holder, Time now);

  /// Whose it is; after that it is nobody's.
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
