// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "ltm/context/context_runs.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// A pinhole camera without distortion: u = fx x / z + cx, v = fy y / z + cy; the centre of the
/// pixel at the top left is (0, 0). Frame: x right, y down, z forward. Unit: pixels.
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  double width = 0, height = 0;

  friend bool operator==(const Intrinsics&, const Intrinsics&) = default;
};

/// Where the snapshots of an entity were, what they link to, and when what they tell of went on.
/// Columns, because there may be millions: the rows of a table are ordered by snapshot.
///
/// Threading: immutable once it is made.
/// Source: docs/query.md, "Places".
struct EntityContext {
  /// Whether something that was looked at was seen, as its snapshots say.
  enum class Visibility : int8_t { kUntold = -1, kHidden = 0, kVisible = 1 };

  /// The poses in the values.
  struct Places {
    std::vector<uint32_t> snapshot;  ///< N, indices into `times`.
    std::vector<uint32_t> frame;     ///< N, indices into `frames`.
    std::vector<double> position;    ///< [N, 3] in m.
    [[nodiscard]] size_t size() const { return snapshot.size(); }
    friend bool operator==(const Places&, const Places&) = default;
  };
  /// The poses of cameras.
  struct Cameras {
    std::vector<uint32_t> snapshot;   ///< N
    std::vector<int32_t> instance;    ///< N, of the value.
    std::vector<uint32_t> frame;      ///< N
    std::vector<double> position;     ///< [N, 3] in m.
    std::vector<double> orientation;  ///< [N, 4] w, x, y, z: camera to frame.
    /// N: from 0 on the row of `links` that leads to the intrinsics; -1 - i if they are number i of
    /// `intrinsics`.
    std::vector<int32_t> calibration;
    [[nodiscard]] size_t size() const { return snapshot.size(); }
    friend bool operator==(const Cameras&, const Cameras&) = default;
  };
  struct Links {
    /// A link to an entity, and not to one of its snapshots or instances.
    static constexpr int64_t kNoTime = std::numeric_limits<int64_t>::min();
    static constexpr int32_t kNoInstance = -1;
    std::vector<uint32_t> snapshot;  ///< N
    std::vector<int32_t> instance;   ///< N, of the value that links.
    std::vector<uint32_t> target;    ///< N, indices into `targets`.
    std::vector<int64_t> time;       ///< N, of what it links to. Unit: ns.
    std::vector<int32_t> index;      ///< N, of the instance that it links to.
    [[nodiscard]] size_t size() const { return snapshot.size(); }
    friend bool operator==(const Links&, const Links&) = default;
  };
  /// What has a start: actions.
  struct Spans {
    static constexpr int64_t kOpen = std::numeric_limits<int64_t>::max();
    std::vector<uint32_t> snapshot;  ///< N
    std::vector<int64_t> started;    ///< N. Unit: ns.
    std::vector<int64_t> ended;      ///< N; kOpen if the snapshot tells no end. Unit: ns.
    [[nodiscard]] size_t size() const { return snapshot.size(); }
    friend bool operator==(const Spans&, const Spans&) = default;
  };

  std::vector<Time> times;             ///< Of all snapshots, increasing.
  std::vector<Visibility> visibility;  ///< One for each; empty if none tells.
  Places places;
  Cameras cameras;
  Links links;
  Spans spans;
  /// An empty frame is one that the values do not name.
  std::vector<std::string> frames;
  std::vector<Intrinsics> intrinsics;  ///< Of cameras whose own values have them.
  std::vector<MemoryId> targets;       ///< Entities.

  /// Bounds of runs of places and cameras, which find_runs() makes; two contexts are equal whether
  /// they have them or not.
  struct Runs {
    std::shared_ptr<const ContextRuns> found;
    friend bool operator==(const Runs&, const Runs&) { return true; }
  };
  Runs runs;
  /// Makes questions about places quicker, once everything else is there; without it they have the
  /// same answers.
  void find_runs();

  /// What a row of the links leads to: an entity, a snapshot or an instance.
  [[nodiscard]] MemoryId link(size_t row) const;

  /// Bytes in memory, about.
  [[nodiscard]] size_t held_bytes() const;

  /// The index of the snapshot of this time.
  [[nodiscard]] std::optional<uint32_t> find(Time time) const;

  friend bool operator==(const EntityContext&, const EntityContext&) = default;
};

/// The indices of values in a list that has each once. There may be as many as there are snapshots.
///
/// Threading: one thread.
template <typename T>
class KnownIndices {
 public:
  /// The index of `value` in `list`, to which it is added if it is new.
  uint32_t of(const T& value, std::vector<T>& list) {
    const auto [found, is_new] = known_.try_emplace(value, static_cast<uint32_t>(list.size()));
    if (is_new) list.push_back(value);
    return found->second;
  }

 private:
  std::unordered_map<T, uint32_t> known_;
};

/// Copies snapshots of several contexts of one entity into one, in the order of time.
///
/// Threading: one thread.
class ContextMerger {
 public:
  /// Adds a snapshot of `from`, later than all that were added. Of one source they come in order.
  void add(const EntityContext& from, uint32_t snapshot);

  [[nodiscard]] EntityContext take() && {
    merged_.find_runs();
    return std::move(merged_);
  }

 private:
  /// How far a source was copied, and what its names are in the result.
  struct Source {
    const EntityContext* from = nullptr;
    size_t place = 0, camera = 0, link = 0, span = 0;
    std::vector<uint32_t> frames, intrinsics, targets;
  };

  Source& source_of(const EntityContext& from);

  EntityContext merged_;
  KnownIndices<std::string> frames_;
  KnownIndices<MemoryId> targets_;
  std::vector<Source> sources_;
  size_t last_ = 0;
};

/// Where the rows of a snapshot begin in a column of snapshots.
[[nodiscard]] size_t first_row(const std::vector<uint32_t>& snapshots, uint32_t snapshot);

/// The index of intrinsics in a list, to which they are added if they are not among the last ones:
/// a camera has the same for long, or other ones each time.
uint32_t index_of_lens(std::vector<Intrinsics>& known, const Intrinsics& lens);

}  // namespace engram::ltm
