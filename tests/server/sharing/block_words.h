// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <istream>
#include <string>

#include "server/sharing/block_ref.h"

namespace engram::testing {

/// What tests and sharing_peer tell each other, as text.
inline std::string words_of(const server::BlockRef& block) {
  return fmt::format("{} {} {} {}", block.slab, block.offset, block.capacity, block.generation);
}

inline server::BlockRef block_of(std::istream& words) {
  server::BlockRef block;
  words >> block.slab >> block.offset >> block.capacity >> block.generation;
  return block;
}

inline std::string words_of(const server::Ticket& ticket) {
  std::string digits;
  for (const std::byte one : ticket) digits += fmt::format("{:02x}", std::to_integer<int>(one));
  return digits;
}

/// Needs as many digits as words_of writes (throws).
inline server::Ticket ticket_of(const std::string& digits) {
  server::Ticket ticket{};
  for (size_t i = 0; i < ticket.size(); ++i)
    ticket[i] = std::byte(std::stoul(digits.substr(2 * i, 2), nullptr, 16));
  return ticket;
}

}  // namespace engram::testing
