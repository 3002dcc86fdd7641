// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"

namespace engram::ltm {

/// The address of anything in a memory: a prefix of memory / core segment / provider segment /
/// entity / timestamp / instance index. It addresses, links and prints every level.
///
/// A name is any text of valid UTF-8 that is not empty; control characters are allowed and print as
/// they are. IDs are ordered by names (bytewise), time and index: an ID comes right before
/// everything below it.
/// Threading: immutable except for assignment.
/// Source: docs/design.md, section 2.
class MemoryId {
 public:
  static constexpr size_t kNameLevels = 4;

  /// The empty ID, which stands for all memories.
  MemoryId() = default;

  /// Reads "Vision/RGB/head/cam/2022-02-18 13:06:56.492182/0" or any prefix of it. A `/` inside a
  /// name is written `\/`, a backslash `\\`.
  /// Errors: kInvalidArgument naming the text and the part that does not fit.
  static Result<MemoryId> parse(std::string_view text);

  /// The first names of an ID: at most four, valid UTF-8, none of them empty.
  /// Errors: kInvalidArgument.
  static Result<MemoryId> from_names(std::vector<std::string> names);

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming what was found and what was needed.
  static Result<MemoryId> from_data(const idf::Data& data);

  /// The printed form as a value, which is the form of links inside data.
  [[nodiscard]] idf::Data to_data() const { return to_string(); }

  /// The ID one level above. Needs an ID that is not empty (checked).
  [[nodiscard]] MemoryId parent() const;

  /// The segment or entity `name` directly below this. Needs fewer than four names (checked).
  /// Errors: kInvalidArgument where `name` is empty or no UTF-8.
  Result<MemoryId> child(std::string_view name) const;

  /// This entity at `time`. Needs an ID of an entity or deeper (checked).
  [[nodiscard]] MemoryId at(Time time) const;

  /// Instance `index` of this snapshot. Needs an ID of a snapshot or deeper, and an index that is
  /// not negative (checked).
  [[nodiscard]] MemoryId instance(int32_t index) const;

  /// The ID of the entity that this belongs to. Needs an entity or deeper (checked).
  [[nodiscard]] MemoryId entity() const;

  [[nodiscard]] const std::vector<std::string>& names() const {
    return names_ == nullptr ? kNoNames : *names_;
  }
  [[nodiscard]] std::optional<Time> time() const { return time_; }
  [[nodiscard]] std::optional<int32_t> index() const { return index_; }

  /// The number of levels that are set: 0 (empty) to 6 (an instance).
  [[nodiscard]] size_t depth() const {
    return names().size() + (time_ ? 1 : 0) + (index_ ? 1 : 0);
  }

  [[nodiscard]] bool has_entity() const { return names().size() == kNameLevels; }
  [[nodiscard]] bool is_entity() const { return has_entity() && !time_; }

  /// True where `other` is this ID or lies below it.
  [[nodiscard]] bool is_prefix_of(const MemoryId& other) const;

  [[nodiscard]] std::string to_string() const;

  /// The same for a person to read, who must not mistake a name for more than that
  /// (ltm/core/printable.h). It cannot always be parsed.
  [[nodiscard]] std::string printable() const;

  /// Equal for all copies of an ID within one process; allocates nothing.
  [[nodiscard]] size_t hash() const;

  friend bool operator==(const MemoryId& a, const MemoryId& b) {
    return (a.names_ == b.names_ || a.names() == b.names()) && a.time_ == b.time_ &&
           a.index_ == b.index_;
  }

  friend std::strong_ordering operator<=>(const MemoryId& a, const MemoryId& b) {
    if (a.names_ != b.names_)
      if (const auto order = a.names() <=> b.names(); order != 0) return order;
    if (const auto order = a.time_ <=> b.time_; order != 0) return order;
    return a.index_ <=> b.index_;
  }

 private:
  using Names = std::vector<std::string>;
  static const Names kNoNames;

  void set_names(Names names);

  /// Null: none. Copies share them, since a memory of 100,000 entities has each ID several times,
  /// and names take 180 bytes.
  std::shared_ptr<const Names> names_;
  std::optional<Time> time_;
  std::optional<int32_t> index_;
};

}  // namespace engram::ltm

template <>
struct std::hash<engram::ltm::MemoryId> {
  size_t operator()(const engram::ltm::MemoryId& id) const { return id.hash(); }
};
