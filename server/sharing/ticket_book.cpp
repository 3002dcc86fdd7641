// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/ticket_book.h"

#include <sys/random.h>

#include "server/sharing/descriptor.h"

namespace engram::server {

namespace {

/// Takes the same time wherever the tickets differ, so that a guess learns nothing from it.
bool is_same(const Ticket& a, const Ticket& b) {
  std::byte difference{0};
  for (size_t i = 0; i < a.size(); ++i) difference |= a[i] ^ b[i];
  return difference == std::byte{0};
}

}  // namespace

Result<Ticket> TicketBook::issue(TicketHolder holder, Time now) {
  Ticket ticket;
  if (::getrandom(ticket.data(), ticket.size(), 0) != static_cast<ssize_t>(ticket.size()))
    return system_status("sharing: no random numbers");
  const MutexLock lock(mutex_);
  std::erase_if(issued_, [&](const Issued& one) {
    return one.expires <= now || one.holder.client == holder.client;
  });
  if (issued_.size() >= max_)
    return resource_exhausted("sharing: {} tickets wait for their clients, needs fewer than {}",
                              issued_.size(), max_);
  issued_.push_back({ticket, std::move(holder), now + lifetime_});
  return ticket;
}

std::optional<TicketHolder> TicketBook::redeem(const Ticket& ticket, Time now) {
  const MutexLock lock(mutex_);
  std::erase_if(issued_, [&](const Issued& one) { return one.expires <= now; });
  auto found = issued_.end();
  for (auto one = issued_.begin(); one != issued_.end(); ++one)
    if (is_same(one->ticket, ticket)) found = one;
  if (found == issued_.end()) return std::nullopt;
  TicketHolder holder = std::move(found->holder);
  issued_.erase(found);
  return holder;
}

}  // namespace engram::server
