// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "ltm/codec/group_codec.h"
#include "ltm/codec/packed_value.h"

namespace engram::ltm {

/// What becomes of the values of an entity when its journal is sealed: which images are put
/// together as groups, and which numbers as compressed columns. By default all stays as it is.
///
/// Threading: immutable, const-parallel. Copies share the codecs.
/// Source: docs/recording.md, section "Rules".
class SealRules {
 public:
  SealRules() = default;

  /// The seal-time part of the rules that values are packed by.
  /// Errors: kInvalidArgument if `options` do not validate; kFailedPrecondition where an encoder
  /// is not installed.
  static Result<SealRules> create(const PackOptions& options);

  /// Rules under which the numbers at these paths, and no others, become columns; images stay.
  static SealRules columns(std::set<std::string, std::less<>> paths);

  /// Rules under which all numbers do.
  static SealRules all_columns();

  /// True where all stays as it is.
  [[nodiscard]] bool empty() const { return plan_ == nullptr; }

  /// Null where arrays of this path, type and shape stay single. Valid as long as the rules.
  [[nodiscard]] const GroupCodec* group_codec(std::string_view path, idf::ElementType type,
                                              const idf::Shape& shape) const;

  /// True where the number or array at `path` becomes a compressed column.
  [[nodiscard]] bool are_columns(std::string_view path) const;

 private:
  struct Plan;

  std::shared_ptr<const Plan> plan_;  ///< Null: none.
};

}  // namespace engram::ltm
