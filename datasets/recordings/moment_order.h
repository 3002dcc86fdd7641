// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "datasets/recordings/recording_reader.h"

namespace engram::datasets {

/// Moves times such that the first one is at a start.
///
/// Threading: one thread.
class TimeShift {
 public:
  /// Nothing: times stay.
  explicit TimeShift(std::optional<Time> start) : start_(start) {}

  /// Times that would leave what there is stay. Unit: ns since 1970.
  Time shifted(int64_t ns);

 private:
  std::optional<Time> start_;
  std::optional<int64_t> shift_ns_;
};

/// Values in the order of a file as values that may be committed: times never decrease, and those
/// of one entity increase.
///
/// Threading: one thread.
class MomentOrder {
 public:
  /// Moves `update` behind those before it, and tells. `repeats`: the file has its time twice.
  void put(bool repeats, ltm::EntityUpdate& update, ReadingReport& report);

 private:
  Time last_ = Time::min();
  std::set<ltm::MemoryId> at_last_;  ///< Entities that have a value at `last_`.
};

/// Entities of one recording; none is given twice.
class FreeEntities {
 public:
  /// Whether it was free.
  bool take(const ltm::MemoryId& entity) { return entities_.insert(entity).second; }

  /// "name", or "name_2" and so on. Needs names that a MemoryID can have (checked).
  ltm::MemoryId take(const std::string& memory, const std::string& segment,
                     const std::string& provider, const std::string& name);

 private:
  std::set<ltm::MemoryId> entities_;
};

/// "camera.image" of the topic "/camera/image"; `other` where it has no name, or is no UTF-8.
[[nodiscard]] std::string name_of_topic(std::string_view topic, std::string_view other);

/// The entity that `text`, which we wrote into a file, names; empty where it names none, or one of
/// descriptions.
[[nodiscard]] ltm::MemoryId own_entity(std::string_view text);

}  // namespace engram::datasets
