// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a redaction of a store has done and has still to do, until the
// originals are gone.

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "ltm/redaction/redactor.h"
#include "ltm/store/rewrite.h"

namespace engram::ltm {

/// What a redaction notes of one entity.
struct PendingEntity {
  struct Redacted {
    uint64_t raw_bytes = 0;
    bool is_counted = false;  ///< The store counts the original as forgotten.
    uint64_t boxes = 0;       ///< That were found in it.
  };
  struct Sums {
    uint64_t snapshots = 0;
    uint64_t raw_bytes = 0;
  };
  /// A box that was found in a snapshot, and holds in those after it.
  struct Held {
    Time time{};
    SeenBox seen;
  };

  /// Recorded anew, or just about to be.
  std::map<Time, Redacted> redacted;
  /// What the store's manifest says of forgotten snapshots once the originals are counted there. It
  /// tells the next run whether a killed one got so far.
  std::optional<Sums> counting;
  /// They are to be forgotten, by RedactAction::kDrop, and the boxes that were found in them.
  std::map<Time, uint64_t> dropped;
  TimeSet made;  ///< Augmented snapshots that were made of redacted ones, and go with them.
  std::vector<Held> held;

  [[nodiscard]] bool empty() const {
    return redacted.empty() && dropped.empty() && made.empty() && held.empty();
  }
};

struct PendingRedaction {
  /// What was recorded anew is in segments of this number or above.
  uint64_t first_segment = 0;
  uint64_t bytes_before = 0;  ///< Of the store's directory when the first run began.
  std::map<MemoryId, PendingEntity> entities;

  /// The snapshots whose originals may still be there.
  [[nodiscard]] ForgetSet redacted() const;
  [[nodiscard]] ForgetSet dropped() const;
  [[nodiscard]] ForgetSet made() const;
  [[nodiscard]] uint64_t snapshots() const;  ///< Without those that were made of others.
};

/// None where there is no such file.
/// Errors: kDataLoss if the file is damaged; kUnavailable.
Result<std::optional<PendingRedaction>> read_pending_redaction(const std::filesystem::path& store);

/// Replaces the file, which is on the disk after ok.
/// Errors: kUnavailable, kResourceExhausted.
Status write_pending_redaction(const std::filesystem::path& store, const PendingRedaction& pending);

/// Errors: kUnavailable.
Status remove_pending_redaction(const std::filesystem::path& store);

}  // namespace engram::ltm
