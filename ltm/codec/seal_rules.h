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

/// How the values of an entity are stored when its journal is sealed: which images become groups,
/// and which numbers become compressed columns. By default everything stays as it is.
///
/// Threading: immutable, const-parallel. Copies share the codecs.
/// Source: docs/recording.md, section "Rules".
class SealRules {
 public:
  SealRules() = default;

  /// The part of the packing rules that applies when data is sealed.
  /// Errors: kInvalidArgument if `options` do not validate; kFailedPrecondition if an encoder is
  /// not installed.
  static Result<SealRules> create(const PackOptions& options);

  /// Rules that make the numbers at these paths, and no others, columns. Images stay as they are.
  static SealRules columns(std::set<std::string, std::less<>> paths);

  /// Rules that make all numbers columns.
  static SealRules all_columns();

  /// True if everything stays as it is.
  [[nodiscard]] bool empty() const { return plan_ == nullptr; }

  /// The group codec for arrays of this path, type and shape, or null if they stay single. Valid as
  /// long as the rules.
  [[nodiscard]] const GroupCodec* group_codec(std::string_view path, idf::ElementType type,
                                              const idf::Shape& shape) const;

  /// True if the number or array at `path` becomes a compressed column.
  [[nodiscard]] bool are_columns(std::string_view path) const;

 private:
  struct Plan;

  std::shared_ptr<const Plan> plan_;  ///< Null if there are no rules.
};

}  // namespace engram::ltm
