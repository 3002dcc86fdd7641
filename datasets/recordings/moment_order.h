// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "datasets/recordings/recording_reader.h"

namespace engram::datasets {

/// Shifts times so that the first one falls on a given start.
///
/// Threading: one thread.
class TimeShift {
 public:
  /// Times are not changed if `start` is empty.
  explicit TimeShift(std::optional<Time> start) : start_(start) {}

  /// A time is not changed if the shift would move it out of the range of Time. Unit: ns since
  /// 1970.
  Time shifted(int64_t ns);

 private:
  std::optional<Time> start_;
  std::optional<int64_t> shift_ns_;
};

/// Turns values in the order of a file into values that may be committed: their times never
/// decrease, and the times of one entity increase.
///
/// Threading: one thread.
class MomentOrder {
 public:
  /// Moves `update` behind the values before it if needed, and reports that. `repeats`: the file
  /// contains this time twice.
  void put(bool repeats, ltm::EntityUpdate& update, ReadingReport& report);

 private:
  Time last_ = Time::min();
  std::set<ltm::MemoryId> at_last_;  ///< Entities with a value at `last_`.
};

/// Groups values that arrive one by one into moments: values with equal times form one moment.
///
/// Threading: one thread.
class MomentsOfValues {
 public:
  /// Returns the next value, in the order of MomentOrder; nothing after the last one.
  using Pull = std::function<Result<std::optional<ltm::EntityUpdate>>()>;

  explicit MomentsOfValues(Pull pull) : pull_(std::move(pull)) {}

  /// The time of the next moment; nothing after the last one. This and take() fail with the errors
  /// of Pull.
  Result<std::optional<Time>> next_time();

  /// Puts the values of the next moment into `commit`. There must be one (checked).
  Status take(ltm::Commit& commit);

 private:
  Pull pull_;
  std::optional<ltm::EntityUpdate> waiting_;
};

/// Assigns the entities of one recording. No entity is assigned twice.
class FreeEntities {
 public:
  /// Returns true if the entity was free.
  bool take(const ltm::MemoryId& entity) { return entities_.insert(entity).second; }

  /// Assigns "name", or "name_2" and so on. Errors: those of MemoryId::from_names.
  Result<ltm::MemoryId> take(const std::string& memory, const std::string& segment,
                             const std::string& provider, const std::string& name);

  /// Assigns the entity that `own`, text from a file, names (own_entity), if it names one and that
  /// is free; else an entity from the other names.
  Result<ltm::MemoryId> take_own(std::string_view own, const std::string& memory,
                                 const std::string& segment, const std::string& provider,
                                 const std::string& name);

 private:
  std::set<ltm::MemoryId> entities_;
};

/// Returns "camera.image" for the topic "/camera/image"; `other` if the topic has no name or is not
/// UTF-8.
[[nodiscard]] std::string name_of_topic(std::string_view topic, std::string_view other);

/// Returns the entity that `text`, which our export wrote into a file, names. The result is empty
/// if it names none, or names one of the descriptions.
[[nodiscard]] ltm::MemoryId own_entity(std::string_view text);

}  // namespace engram::datasets
