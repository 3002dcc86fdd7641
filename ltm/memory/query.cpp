// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/query.h"

#include <algorithm>
#include <span>

#include "ltm/memory/query_builder.h"

namespace engram::ltm {

namespace {

template <typename Below>
NameQuery<Below>& find_or_add(std::vector<NameQuery<Below>>& siblings, const NamePattern& name) {
  const auto known = std::ranges::find(siblings, name, &NameQuery<Below>::name);
  return known != siblings.end() ? *known : siblings.emplace_back(NameQuery<Below>{name, {}});
}

void add_snapshots(std::vector<SnapshotQuery>& siblings, SnapshotQuery added) {
  std::ranges::sort(added.instances);
  added.instances.erase(std::unique(added.instances.begin(), added.instances.end()),
                        added.instances.end());
  const auto known = std::ranges::find_if(siblings, [&added](const SnapshotQuery& sibling) {
    return sibling.selector == added.selector && sibling.conditions == added.conditions;
  });
  if (known == siblings.end()) {
    siblings.push_back(std::move(added));
  } else if (known->instances.empty() || added.instances.empty()) {
    // Empty instances mean all, so they absorb any others.
    known->instances.clear();
  } else {
    std::vector<int32_t> united;
    std::ranges::set_union(known->instances, added.instances, std::back_inserter(united));
    known->instances = std::move(united);
  }
}

/// Adds every branch of a tree below `path`, whose first `Level` levels are set.
template <size_t Level, typename Below>
Status add_branches(const std::vector<NameQuery<Below>>& level, QueryPath& path,
                    QueryBuilder& builder) {
  if (level.empty()) return invalid_argument("query: level {} has no names", Level + 1);
  for (const NameQuery<Below>& query : level) {
    path[Level] = query.name;
    if constexpr (std::is_same_v<Below, SnapshotQuery>) {
      if (query.below.empty())
        return invalid_argument("query: entity '{}' has no selector of snapshots",
                                query.name.to_string());
      for (const SnapshotQuery& snapshots : query.below)
        ENGRAM_RETURN_IF_ERROR(builder.add(path, snapshots));
    } else {
      ENGRAM_RETURN_IF_ERROR(add_branches<Level + 1>(query.below, path, builder));
    }
  }
  return {};
}

template <typename Below>
bool matches_names(const std::vector<NameQuery<Below>>& level, std::span<const std::string> names) {
  if (names.empty()) return true;
  return std::ranges::any_of(level, [names](const NameQuery<Below>& query) {
    if (!query.name.matches(names.front())) return false;
    if constexpr (std::is_same_v<Below, SnapshotQuery>)
      return true;
    else
      return matches_names(query.below, names.subspan(1));
  });
}

template <typename Below>
void collect_snapshots(const std::vector<NameQuery<Below>>& level,
                       std::span<const std::string> names, std::vector<SnapshotQuery>& found) {
  for (const NameQuery<Below>& query : level) {
    if (!query.name.matches(names.front())) continue;
    if constexpr (std::is_same_v<Below, SnapshotQuery>)
      for (const SnapshotQuery& snapshots : query.below) add_snapshots(found, snapshots);
    else
      collect_snapshots(query.below, names.subspan(1), found);
  }
}

template <typename Visit>
void for_each_selector(const std::vector<MemoryQuery>& memories, const Visit& visit) {
  for (const auto& memory : memories)
    for (const auto& core : memory.below)
      for (const auto& provider : core.below)
        for (const auto& entity : provider.below)
          for (const SnapshotQuery& snapshots : entity.below) visit(snapshots);
}

}  // namespace

QueryPath path_of(const MemoryId& entity) {
  ENGRAM_CHECK(entity.has_entity(), "'{}' has no entity", entity.to_string());
  QueryPath names;
  for (size_t i = 0; i < names.size(); ++i) {
    auto name = NamePattern::name(entity.names()[i]);
    ENGRAM_CHECK(name.ok(), "{}", name.status().message());
    names[i] = *std::move(name);
  }
  return names;
}

QueryBuilder::QueryBuilder(bool is_ids_only) {
  query_.memories_.clear();
  query_.is_ids_only_ = is_ids_only;
}

Status QueryBuilder::count(const QueryPath& names) {
  if (++selectors_ > Query::kMaxSelectors)
    return invalid_argument("query: has more than {} selectors of snapshots", Query::kMaxSelectors);
  for (const NamePattern& name : names)
    if (name.kind() == NamePattern::Kind::kRegex) expressions_.insert(name.to_string());
  if (expressions_.size() > Query::kMaxExpressions)
    return invalid_argument("query: has more than {} regular expressions", Query::kMaxExpressions);
  return {};
}

Status QueryBuilder::add(const QueryPath& names, SnapshotQuery snapshots) {
  ENGRAM_RETURN_IF_ERROR(validate(snapshots.selector));
  for (const int32_t index : snapshots.instances)
    if (index < 0) return invalid_argument("query: {} is no instance index", index);
  if (snapshots.conditions.size() > Query::kMaxConditions)
    return invalid_argument("query: a selector has more than {} conditions", Query::kMaxConditions);
  for (const Condition& condition : snapshots.conditions)
    ENGRAM_RETURN_IF_ERROR(validate(condition));
  if (!snapshots.conditions.empty() && std::holds_alternative<select::Ahead>(snapshots.selector))
    return invalid_argument(
        "'{}' has conditions, which no prediction meets: needs a selector of the past",
        to_string(snapshots.selector));
  ENGRAM_RETURN_IF_ERROR(count(names));
  // Merging into siblings keeps the normal form, in which equal selections have equal trees.
  auto& core_segments = find_or_add(query_.memories_, names[0]).below;
  auto& provider_segments = find_or_add(core_segments, names[1]).below;
  auto& entities = find_or_add(provider_segments, names[2]).below;
  add_snapshots(find_or_add(entities, names[3]).below, std::move(snapshots));
  return {};
}

Query::Query() : Query({}, select::Latest{}) {}

Query::Query(const std::array<NamePattern, MemoryId::kNameLevels>& names,
             const Selector& selector) {
  const Status valid = validate(selector);
  ENGRAM_CHECK(valid.ok(), "{}", valid.message());
  const EntityQuery entity{names[3], {SnapshotQuery{selector, {}}}};
  memories_ = {{names[0], {{names[1], {{names[2], {entity}}}}}}};
}

Result<Query> Query::create(const std::vector<MemoryQuery>& memories, bool is_ids_only) {
  QueryBuilder builder(is_ids_only);
  QueryPath path;
  ENGRAM_RETURN_IF_ERROR(add_branches<0>(memories, path, builder));
  return std::move(builder).take();
}

Result<Query> Query::from_data(const idf::Data& data) {
  if (const auto* text = data.get_if<std::string>()) return parse(*text);
  return invalid_argument("query: found {}, needs a string", data.kind_name());
}

Query Query::of_entity(const MemoryId& entity, const Selector& selector) {
  return Query(path_of(entity), selector);
}

Result<Query> Query::of_entity(const MemoryId& entity, std::span<const Selector> selectors) {
  if (selectors.empty())
    return invalid_argument("query of '{}': found no selector, needs one", entity.to_string());
  QueryBuilder builder(false);
  const QueryPath path = path_of(entity);
  for (const Selector& selector : selectors)
    ENGRAM_RETURN_IF_ERROR(builder.add(path, {selector, {}}));
  return std::move(builder).take();
}

bool Query::matches(const MemoryId& id) const {
  return matches_names(memories_, id.names());
}

bool Query::has_conditions() const {
  bool has = false;
  for_each_selector(memories_, [&has](const SnapshotQuery& snapshots) {
    has = has || !snapshots.conditions.empty();
  });
  return has;
}

std::vector<MemoryId> Query::condition_entities() const {
  std::vector<MemoryId> entities;
  for_each_selector(memories_, [&entities](const SnapshotQuery& snapshots) {
    for (const Condition& condition : snapshots.conditions)
      if (auto entity = entity_of(condition)) entities.push_back(*std::move(entity));
  });
  std::ranges::sort(entities);
  entities.erase(std::unique(entities.begin(), entities.end()), entities.end());
  return entities;
}

std::vector<SnapshotQuery> Query::snapshots_of(const MemoryId& entity) const {
  ENGRAM_CHECK(entity.has_entity(), "'{}' has no entity", entity.to_string());
  std::vector<SnapshotQuery> found;
  collect_snapshots(memories_, std::span<const std::string>(entity.names()), found);
  return found;
}

std::optional<std::vector<MemoryId>> Query::named_entities() const {
  std::vector<MemoryId> ids;
  const auto is_name = [](const auto& level) {
    return level.name.kind() == NamePattern::Kind::kName;
  };
  for (const auto& memory : memories_)
    for (const auto& core : memory.below)
      for (const auto& provider : core.below)
        for (const auto& entity : provider.below) {
          if (!is_name(memory) || !is_name(core) || !is_name(provider) || !is_name(entity))
            return std::nullopt;
          auto id = MemoryId::from_names(
              {memory.name.text(), core.name.text(), provider.name.text(), entity.name.text()});
          if (!id.ok()) return std::nullopt;
          ids.push_back(*std::move(id));
        }
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace engram::ltm
