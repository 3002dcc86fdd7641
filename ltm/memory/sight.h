// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// A set of times: windows, each from its first to its last nanosecond, both included.
///
/// Threading: immutable except by add().
class TimeWindows {
 public:
  struct Window {
    Time first = time_from_ns(INT64_MIN);
    Time last = time_from_ns(INT64_MAX);

    friend bool operator==(const Window&, const Window&) = default;
  };

  /// All times.
  [[nodiscard]] static TimeWindows all();

  /// Adds a window. One that ends before it begins adds nothing.
  void add(const Window& window);

  [[nodiscard]] bool empty() const { return windows_.empty(); }
  [[nodiscard]] bool is_all() const;
  [[nodiscard]] bool contains(Time time) const;

  /// The windows in order. No two of them touch.
  [[nodiscard]] std::span<const Window> windows() const { return windows_; }

 private:
  std::vector<Window> windows_;
};

/// What somebody may see of one entity.
struct Sight {
  TimeWindows times;  ///< Of which snapshots. Empty: the entity is not there.
  /// Of which of these the images as they are. Of others only redacted ones.
  TimeWindows exact;
  bool predictions = false;  ///< Also what models and engines say, which learned from all times.

  /// Whether all of the past may be seen as it is.
  [[nodiscard]] bool is_whole() const { return times.is_all() && exact.is_all(); }
  [[nodiscard]] bool is_all() const { return is_whole() && predictions; }
};

/// What somebody may see of a memory. Answers that are made for a view are as if there were nothing
/// else: `latest` is the last snapshot that may be seen, and messages name no other entity.
///
/// Threading: thread-safe.
/// Source: docs/access.md, "Grants".
class View {
 public:
  virtual ~View() = default;

  /// What may be seen of an entity now.
  [[nodiscard]] virtual Sight of(const MemoryId& entity) const = 0;
};

/// Null sees everything.
using SharedView = std::shared_ptr<const View>;

/// What `view` sees of an entity; everything if it is null.
[[nodiscard]] Sight sight_of(const View* view, const MemoryId& entity);

}  // namespace engram::ltm
