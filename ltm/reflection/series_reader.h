// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: values become columns.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/type.h"
#include "ltm/reflection/link_targets.h"
#include "ltm/reflection/series_block.h"

namespace engram::ltm {

/// Splits the values of one instance of an entity into columns, whatever they look like. Values of
/// one layout cost no look-ups: each is walked beside the one before it.
///
/// Threading: one thread. The targets must outlive it.
class SeriesReader {
 public:
  /// Arrays of more elements are no series: point clouds, maps.
  static constexpr size_t kMaxElements = 1024;
  /// Elements of all members of a value.
  static constexpr size_t kMaxWidth = 8192;

  /// `type` is the type of the values; none where it is not known.
  SeriesReader(SeriesBlock empty, std::optional<idf::Type> type, LinkTargets& targets);
  ~SeriesReader();
  SeriesReader(SeriesReader&&) noexcept;

  /// Adds a row. Errors: those of LinkTargets.
  Status add(Time time, Time arrived, const idf::Data& value);
  /// Adds an image to the row that was added last.
  void add_image(const std::string& path, uint64_t hash);

  /// The numbers that are held.
  [[nodiscard]] size_t held() const { return held_; }

  /// Hands over what was read, and starts anew with the same members.
  SeriesBlock take();

 private:
  struct Node;

  Status walk(const idf::Data& value, Node& node);
  Status walk_dict(const idf::Dict& dict, Node& node);
  Status walk_list(const idf::List& list, Node& node);
  void add_number(double number, Node& node, NumberColumn::Meaning meaning);
  void add_array(const idf::NdArray& array, Node& node);
  Status add_text(const std::string& text, Node& node);
  NumberColumn* column_of(Node& node, size_t width, NumberColumn::Meaning meaning);
  void mix(uint64_t hash, bool is_value);

  SeriesBlock block_;
  std::unique_ptr<Node> root_;
  LinkTargets* targets_;
  size_t held_ = 0;
  size_t width_ = 0;
  uint64_t value_hash_ = 0;
  uint64_t full_hash_ = 0;
};

}  // namespace engram::ltm
