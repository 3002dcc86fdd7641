// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <set>
#include <string>

#include "ltm/memory/query.h"

namespace engram::ltm {

/// The names from the root of a query to the snapshots of an entity.
using QueryPath = std::array<NamePattern, MemoryId::kNameLevels>;

/// The names of an entity as patterns that match nothing else. Needs the ID of an entity or deeper
/// (checked).
[[nodiscard]] QueryPath path_of(const MemoryId& entity);

/// Builds a query in normal form, selector by selector.
///
/// Threading: one thread.
class QueryBuilder {
 public:
  explicit QueryBuilder(bool is_ids_only);

  /// Errors: kInvalidArgument where the selector does not validate, an instance is negative, or
  /// the query exceeds its limits.
  Status add(const QueryPath& names, SnapshotQuery snapshots);

  [[nodiscard]] Query take() && { return std::move(query_); }

 private:
  Status count(const QueryPath& names);

  Query query_;
  size_t selectors_ = 0;
  std::set<std::string> expressions_;
};

}  // namespace engram::ltm
