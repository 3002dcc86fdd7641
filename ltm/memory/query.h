// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/memory/memory_id.h"
#include "ltm/memory/name_pattern.h"
#include "ltm/memory/selector.h"
#include "ltm/memory/snapshot_condition.h"

namespace engram::ltm {

/// Selects snapshots of an entity and some or all of their instances.
struct SnapshotQuery {
  Selector selector = select::Latest{};
  /// Indices of the instances, none of them negative; empty: all.
  std::vector<int32_t> instances;
  /// What a snapshot must meet. The selector selects among the snapshots that meet all of them, and
  /// nothing of the future: `latest` is the last one that does. Empty: it selects among all.
  std::vector<Condition> conditions{};

  friend bool operator==(const SnapshotQuery&, const SnapshotQuery&) = default;
};

/// Selects names of one level, and what to select below them.
template <typename Below>
struct NameQuery {
  NamePattern name;
  std::vector<Below> below;

  friend bool operator==(const NameQuery&, const NameQuery&) = default;
};

using EntityQuery = NameQuery<SnapshotQuery>;
using ProviderSegmentQuery = NameQuery<EntityQuery>;
using CoreSegmentQuery = NameQuery<ProviderSegmentQuery>;
using MemoryQuery = NameQuery<CoreSegmentQuery>;

/// A query to a memory: a tree that mirrors the hierarchy, with several selectors on each level,
/// each with its own sub-queries. The answers of all branches are united.
///
/// It is kept in normal form: on no level do two siblings have the same names or the same selector
/// with the same conditions, and instances are sorted. The text form has one branch per entity
/// level:
///
///     [?ids] NAMES [@ SELECTOR[#INSTANCE]... [CONDITION ...], ...] [; NAMES ...]
///
/// NAMES are `<memory>/<core>/<provider>/<entity>`, each a NamePattern. Missing levels match all
/// names, and a missing selector is `latest`; see parse_selector for selectors, and
/// parse_conditions for conditions. `?ids` requests IDs without data. Example: `Vision/.*/head/cam
/// @ last:10s, nearest:T~50ms#0 ; Robot @ -3..-1` Threading: immutable except for assignment.
/// Source: docs/query.md.
class Query {
 public:
  /// The bound of snapshot selectors, over all branches.
  static constexpr size_t kMaxSelectors = 1024;
  /// The bound of conditions of one selector.
  static constexpr size_t kMaxConditions = 16;
  /// The bound of different regular expressions; each may need 1 MiB.
  static constexpr size_t kMaxExpressions = 256;

  /// Selects the latest snapshot of every entity.
  Query();

  /// A query of one branch. Needs a selector that validates (checked).
  Query(const std::array<NamePattern, MemoryId::kNameLevels>& names, const Selector& selector);

  /// Builds a query of any tree and brings it into normal form.
  /// Errors: kInvalidArgument where a level is empty, a selector does not validate, an instance is
  /// negative, or the tree exceeds the bounds above.
  static Result<Query> create(const std::vector<MemoryQuery>& memories, bool is_ids_only = false);

  /// Reads the text form.
  /// Errors: kInvalidArgument naming the text, the position, the part that does not fit and what
  /// was needed.
  static Result<Query> parse(std::string_view text);

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument.
  static Result<Query> from_data(const idf::Data& data);

  /// A query of exactly one entity. Needs the ID of an entity or deeper, and a selector that
  /// validates (checked).
  static Query of_entity(const MemoryId& entity, const Selector& selector);

  /// The same of a selector with instances and conditions in text form: "latest:3#0 while ENTITY".
  /// Errors: those of parse(); kInvalidArgument if `entity` has a time.
  static Result<Query> of_entity(const MemoryId& entity, std::string_view snapshots,
                                 bool is_ids_only = false);

  /// A query of exactly one entity with several selectors, at least one.
  /// Errors: kInvalidArgument where one does not validate, or where there are too many.
  static Result<Query> of_entity(const MemoryId& entity, std::span<const Selector> selectors);

  [[nodiscard]] const std::vector<MemoryQuery>& memories() const { return memories_; }

  /// True where the query requests IDs without data.
  [[nodiscard]] bool is_ids_only() const { return is_ids_only_; }

  /// True where the query matches the names in `id`, whatever lies below them.
  [[nodiscard]] bool matches(const MemoryId& id) const;

  /// What all branches that match this entity select of it; empty where none matches. Needs the ID
  /// of an entity or deeper (checked).
  [[nodiscard]] std::vector<SnapshotQuery> snapshots_of(const MemoryId& entity) const;

  /// Whether any of its selectors has conditions.
  [[nodiscard]] bool has_conditions() const;

  /// The entities that its conditions name, sorted and without duplicates, for who has to know
  /// their places and context elsewhere.
  [[nodiscard]] std::vector<MemoryId> condition_entities() const;

  /// A text that parse reads back to the same tree.
  [[nodiscard]] std::string to_string() const;

  /// The entities that the query names letter by letter, sorted and without duplicates; nothing
  /// where any of its names is a pattern.
  [[nodiscard]] std::optional<std::vector<MemoryId>> named_entities() const;

  /// The text form as a value.
  [[nodiscard]] idf::Data to_data() const { return to_string(); }

  friend bool operator==(const Query&, const Query&) = default;

 private:
  friend class QueryBuilder;

  std::vector<MemoryQuery> memories_;
  bool is_ids_only_ = false;
};

}  // namespace engram::ltm
