// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what the holder of a token may do.

#include <optional>
#include <string_view>
#include <vector>

#include "ltm/core/config.h"
#include "ltm/memory/sight.h"
#include "server/access/right.h"

namespace engram::server {

/// Reads a time of a tokens file.
/// Errors: kInvalidArgument naming file, line and key.
[[nodiscard]] Result<Time> read_time(const ConfigValue& config);

/// What the holder of a token may do with some entities at some times.
struct Grant {
  std::vector<ltm::MemoryId> ids;  ///< Prefixes; the empty ID covers everything.
  std::vector<Right> may;
  ltm::TimeWindows::Window window;  ///< Of snapshots.
  std::optional<Duration> last;     ///< Instead of a window: those of so long before now.
  bool is_redacted = false;         ///< Images are read redacted.

  /// Whether it lets do this at any time.
  [[nodiscard]] bool gives(Right right, const ltm::MemoryId& id) const;
  [[nodiscard]] ltm::TimeWindows::Window window_at(Time now) const;
};

/// Everything that the holder of a token may do. What one grant gives no other takes away.
///
/// Threading: immutable.
/// Source: docs/access.md, "Grants".
class Grants {
 public:
  static constexpr size_t kMaxGrants = 100;

  /// May do everything.
  static Grants all();

  /// Reads `role` and `memories` of a token, or its `grants`.
  /// Errors: kInvalidArgument naming file, line and key.
  static Result<Grants> read(ConfigMap& token);

  [[nodiscard]] bool give(Right right, const ltm::MemoryId& id) const;

  /// Whether they give it for the ID or for anything that lies below it.
  [[nodiscard]] bool give_below(Right right, const ltm::MemoryId& id) const;

  /// The snapshots with which it may be done.
  [[nodiscard]] ltm::TimeWindows times(Right right, const ltm::MemoryId& id, Time now) const;

  /// Whether any of them gives images redacted.
  [[nodiscard]] bool redact() const;

  /// What may be seen of an entity. Scores of predictions (ltm::score_id) are there for those alone
  /// who may see all of the predicted entity.
  [[nodiscard]] ltm::Sight sight_of(const ltm::MemoryId& entity, Time now) const;

 private:
  std::vector<Grant> grants_;
};

}  // namespace engram::server
