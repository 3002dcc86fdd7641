// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "ltm/core/status.h"

namespace engram::server {

/// Remembers which entries of a ring did not pass, and why: their client asks for each that it saw
/// somebody attend to. Of refused entries the newest are remembered.
///
/// Threading: one thread.
class EntryOutcomes {
 public:
  /// `ring` names the ring in messages.
  explicit EntryOutcomes(std::string ring) : ring_(std::move(ring)) {}

  void refuse(uint64_t sequence, Status why);

  /// Notes that nothing passed of the entries from `first` up to `end`, and nothing ever will.
  void miss(uint64_t first, uint64_t end);

  /// Why an entry did not pass; OK where nothing is known against it.
  /// Errors: those of refuse(); kDataLoss if it was missed, or if too many did not pass since.
  [[nodiscard]] Status of(uint64_t sequence) const;

  /// Whether an entry was missed and nobody was told yet.
  [[nodiscard]] bool is_missed(uint64_t sequence) const;

 private:
  const std::string ring_;
  std::map<uint64_t, Status> refused_;
  uint64_t unknown_below_ = 0;           ///< Some of these did not pass, and are forgotten.
  std::map<uint64_t, uint64_t> missed_;  ///< Ranges: the end by the first.
};

}  // namespace engram::server
