// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the values of an entity, column by column.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// A member of numbers: one number or an array in each row that has it.
///
/// Shape: rows [N], values [width, N], so that an element is read in the order of memory.
struct NumberColumn {
  enum class Meaning : uint8_t {
    kQuantity,     ///< It may move.
    kOrientation,  ///< Quaternions: w, x, y, z.
    kDiscrete,     ///< Bools, enums and counts.
  };

  std::string path;
  size_t width = 1;
  Meaning meaning = Meaning::kQuantity;
  std::string unit;
  std::optional<double> minimum, maximum;  ///< Bounds of the type.
  std::vector<uint32_t> rows;
  std::vector<double> values;

  [[nodiscard]] double at(size_t index, size_t element) const {
    return values[element * rows.size() + index];
  }
  [[nodiscard]] bool is_discrete() const { return meaning == Meaning::kDiscrete; }
  /// "positions[3]", or the path alone where there is one element.
  [[nodiscard]] std::string element_name(size_t element) const {
    return width == 1 ? path : path + "[" + std::to_string(element) + "]";
  }
};

/// Where a link leads.
struct LinkTarget {
  enum class State : uint8_t {
    kFound,
    kNoEntity,    ///< The store has no such entity.
    kNoSnapshot,  ///< The entity has no snapshot at that time.
    kForeign,     ///< The store has nothing of its core segment.
    kForgotten,   ///< The entity has no such snapshot, and snapshots of it were forgotten.
    kBroken,      ///< The text is no ID.
  };
  State state = State::kBroken;
  bool has_time = false;
  int32_t entity = -1;  ///< A number that LinkTargets gave; -1: the store has no such entity.
  int64_t time_ns = 0;
};

/// The links of a member. Lists of links are one member.
struct LinkColumn {
  std::string path;
  std::vector<uint32_t> rows;
  std::vector<LinkTarget> targets;
  /// Texts of the first links that lead nowhere, by row.
  std::vector<std::pair<uint32_t, std::string>> dead;
};

/// Images of a member, each as a hash of what is stored.
struct ImageColumn {
  std::string path;
  std::vector<uint32_t> rows;
  std::vector<uint64_t> hashes;
};

/// Consecutive rows of an entity: one instance of its snapshots.
struct SeriesBlock {
  MemoryId entity;
  int32_t instance = 0;
  bool is_periodic = false;
  double step_s = 0;  ///< The entity's median step.
  std::vector<int64_t> times;
  std::vector<int64_t> latencies;      ///< From the time to the arrival. Unit: ns.
  std::vector<uint64_t> value_hashes;  ///< Of numbers and texts, without times and links.
  std::vector<uint64_t> full_hashes;   ///< Of everything.
  bool has_identity = false;           ///< A time or a link to a moment is among the members.
  std::vector<NumberColumn> numbers;
  std::vector<LinkColumn> links;
  std::vector<ImageColumn> images;

  [[nodiscard]] size_t rows() const { return times.size(); }
};

}  // namespace engram::ltm
