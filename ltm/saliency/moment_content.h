// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/idf/type.h"
#include "ltm/memory/action_outcome.h"

namespace engram::ltm {

/// Numbers of one member of a value: [first, first + width) of MomentContent::numbers.
struct ContentMember {
  std::string path;
  size_t first = 0;
  size_t width = 0;

  friend bool operator==(const ContentMember&, const ContentMember&) = default;
};

/// What a snapshot says, in a form in which it can be compared with others of its entity.
///
/// Numbers are the floats, integers and bools of its value, alone and in arrays of up to 1,024
/// elements. Of a list of values the mean of each member counts, and how many there are, so that
/// lists of other lengths compare. An integer that can only be a time (above 10^15) is left out:
/// it differs always, and so is an array with such. Arrays of bytes are left out: they are images,
/// for which codes stand.
struct MomentContent {
  std::vector<double> numbers;  ///< [D]; not finite ones are 0.
  uint64_t facts = 0;           ///< A hash of all texts that are no links.
  uint64_t links = 0;           ///< A hash of the entities that it leads to; 0 without links.
  bool is_speech = false;
  ActionOutcome outcome = ActionOutcome::kUnknown;
};

/// Reads snapshots of one entity. The members are those of the snapshot that was read last.
///
/// What speech, links and outcomes are is told by ltm/memory/told_events.h.
/// Threading: one thread.
/// Source: docs/saliency.md, section "The parts".
class ContentReader {
 public:
  /// Numbers of all members together; more are left out.
  static constexpr size_t kMaxNumbers = 4096;
  /// Elements of an array; more are an image or a map.
  static constexpr int64_t kMaxElements = 1024;

  /// `type` is the type of the values; none where it is not known.
  explicit ContentReader(std::optional<idf::Type> type) : type_(std::move(type)) {}

  /// Starts a snapshot.
  void begin();
  /// Adds the value of an instance.
  void add(const idf::Data& value);
  /// Adds numbers that are no part of a value, such as a code.
  void add(const std::string& path, const std::vector<double>& numbers);
  /// The snapshot that was begun last. Valid until begin().
  [[nodiscard]] const MomentContent& content() const { return content_; }
  [[nodiscard]] const std::vector<ContentMember>& members() const { return members_; }

 private:
  void walk(const idf::Data& value, const std::string& path);
  void walk_list(const idf::List& list, const std::string& path);
  void add_array(const idf::NdArray& array, const std::string& path);
  void add_number(double number, const std::string& path);
  void add_text(const std::string& text, const std::string& path);
  bool begin_member(const std::string& path, size_t width);

  std::optional<idf::Type> type_;
  MomentContent content_;
  std::vector<ContentMember> members_;
  size_t instance_ = 0;
  int depth_ = 0;
};

}  // namespace engram::ltm
