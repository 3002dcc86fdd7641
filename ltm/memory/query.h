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

namespace engram::ltm {

/// Which snapshots of an entity, and which of their instances.
struct SnapshotQuery {
  Selector selector = select::Latest{};
  /// Indices of the instances, none of them negative; empty: all.
  std::vector<int32_t> instances;

  friend bool operator==(const SnapshotQuery&, const SnapshotQuery&) = default;
};

/// Which names of one level, and what of what lies below them.
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

/// A question to a memory: a tree that mirrors the hierarchy, several selectors on each level,
/// each with its own sub-queries. The answers of all branches are united.
///
/// Kept in normal form: on no level do two siblings have the same names or the same selector, and
/// instances are sorted. Text form, one branch per entity level:
///
///     [?ids] NAMES [@ SELECTOR[#INSTANCE]..., ...] [; NAMES ...]
///
/// NAMES are `<memory>/<core>/<provider>/<entity>`, each a NamePattern; missing levels match all,
/// a missing selector is `latest`; selectors are those of parse_selector. `?ids` asks for IDs
/// without data. `Vision/.*/head/cam @ last:10s, nearest:T~50ms#0 ; Robot @ -3..-1`
/// Threading: immutable but for assignment.
/// Source: docs/query.md.
class Query {
 public:
  /// Most selectors of snapshots, over all branches.
  static constexpr size_t kMaxSelectors = 1024;
  /// Most different regular expressions; each may need 1 MiB.
  static constexpr size_t kMaxExpressions = 256;

  /// Everything's latest.
  Query();

  /// One branch. Needs a selector that validates (checked).
  Query(const std::array<NamePattern, MemoryId::kNameLevels>& names, const Selector& selector);

  /// Brings any tree into normal form.
  /// Errors: kInvalidArgument where a level is empty, a selector does not validate, an instance is
  /// negative, or the tree is larger than the limits above.
  static Result<Query> create(const std::vector<MemoryQuery>& memories, bool is_ids_only = false);

  /// Errors: kInvalidArgument naming the text, the position, the part that does not fit and what
  /// was needed.
  static Result<Query> parse(std::string_view text);

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument.
  static Result<Query> from_data(const idf::Data& data);

  /// The query of exactly one entity. Needs an entity or deeper, and a selector that validates
  /// (checked).
  static Query of_entity(const MemoryId& entity, const Selector& selector);

  /// The same with several selectors, at least one.
  /// Errors: kInvalidArgument where one does not validate, or where there are too many.
  static Result<Query> of_entity(const MemoryId& entity, std::span<const Selector> selectors);

  [[nodiscard]] const std::vector<MemoryQuery>& memories() const { return memories_; }

  /// True where IDs are asked for, without data.
  [[nodiscard]] bool is_ids_only() const { return is_ids_only_; }

  /// True where the names that `id` has are asked for, whatever lies below them.
  [[nodiscard]] bool matches(const MemoryId& id) const;

  /// What is asked of this entity, by all branches that match it; empty where none does.
  /// Needs an entity or deeper (checked).
  [[nodiscard]] std::vector<SnapshotQuery> snapshots_of(const MemoryId& entity) const;

  /// What parse reads back to the same tree.
  [[nodiscard]] std::string to_string() const;

  /// The entities that it names letter by letter, in order, each once; nothing where any of its
  /// names is a pattern.
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
