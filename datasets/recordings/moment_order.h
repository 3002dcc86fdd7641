// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
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

/// Values that come one by one as moments: those of one time together.
///
/// Threading: one thread.
class MomentsOfValues {
 public:
  /// Gives the next value, in the order of MomentOrder; nothing behind the last.
  using Pull = std::function<Result<std::optional<ltm::EntityUpdate>>()>;

  explicit MomentsOfValues(Pull pull) : pull_(std::move(pull)) {}

  /// Time of the next moment; nothing behind the last. Errors: of Pull, here and below.
  Result<std::optional<Time>> next_time();

  /// Puts the values of that moment into `commit`. Needs one (checked).
  Status take(ltm::Commit& commit);

 private:
  Pull pull_;
  std::optional<ltm::EntityUpdate> waiting_;
};

/// Entities of one recording; none is given twice.
class FreeEntities {
 public:
  /// Whether it was free.
  bool take(const ltm::MemoryId& entity) { return entities_.insert(entity).second; }

  /// "name", or "name_2" and so on. Errors: those of MemoryId::from_names.
  Result<ltm::MemoryId> take(const std::string& memory, const std::string& segment,
                             const std::string& provider, const std::string& name);

  /// The entity that `own`, text of a file, names (own_entity), where it does and that is free;
  /// else one of the other names.
  Result<ltm::MemoryId> take_own(std::string_view own, const std::string& memory,
                                 const std::string& segment, const std::string& provider,
                                 const std::string& name);

 private:
  std::set<ltm::MemoryId> entities_;
};

/// "camera.image" of the topic "/camera/image"; `other` where it has no name, or is no UTF-8.
[[nodiscard]] std::string name_of_topic(std::string_view topic, std::string_view other);

/// The entity that `text`, which we wrote into a file, names; empty where it names none, or one of
/// descriptions.
[[nodiscard]] ltm::MemoryId own_entity(std::string_view text);

}  // namespace engram::datasets
