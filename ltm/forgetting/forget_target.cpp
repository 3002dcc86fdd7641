// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_target.h"

#include <utility>

namespace engram::ltm {

namespace {

Result<NamePattern> name_at(const MemoryId& id, size_t level) {
  return level < id.names().size() ? NamePattern::name(id.names()[level]) : NamePattern();
}

/// All that an ID names, without data.
Result<Query> named_by(const MemoryId& id) {
  SnapshotQuery snapshots{select::All{}, {}};
  if (id.time()) snapshots.selector = select::At{*id.time()};
  ENGRAM_ASSIGN_OR_RETURN(NamePattern entity, name_at(id, 3));
  ENGRAM_ASSIGN_OR_RETURN(NamePattern provider, name_at(id, 2));
  ENGRAM_ASSIGN_OR_RETURN(NamePattern core, name_at(id, 1));
  ENGRAM_ASSIGN_OR_RETURN(NamePattern memory, name_at(id, 0));
  return Query::create({{memory, {{core, {{provider, {{entity, {snapshots}}}}}}}}}, true);
}

}  // namespace

Result<ForgetTarget> ForgetTarget::parse(const std::string& text) {
  ForgetTarget target{text, {}, {}, {}, {}};
  auto id = MemoryId::parse(text);
  // The empty ID would be everything, which nobody means with an empty argument.
  if (id.ok() && id->depth() > 0) {
    ENGRAM_ASSIGN_OR_RETURN(Query named, named_by(*id));
    target.meanings.push_back(std::move(named));
    target.id = *std::move(id);
  }
  if (text.find('@') != std::string::npos) {
    const auto query = Query::parse(text);
    if (!query.ok() && !target.id) return query.status();
    target.not_a_query = query.status();
    if (query.ok()) {
      ENGRAM_ASSIGN_OR_RETURN(target.query, Query::create(query->memories(), true));
      target.meanings.push_back(*target.query);
    }
  }
  if (!target.meanings.empty()) return target;
  if (!id.ok()) return id.status();
  return invalid_argument(
      "found '{}' to forget, needs a memory ID, or a query with a selector as in "
      "'Vision/.*/head/cam @ all'",
      text);
}

Status check_forget_targets(const std::vector<std::string>& texts) {
  if (texts.empty()) return invalid_argument("found nothing to forget, needs IDs or queries");
  if (texts.size() > kMaxForgetTargets)
    return invalid_argument("found {} IDs and queries to forget, needs at most {}", texts.size(),
                            kMaxForgetTargets);
  return {};
}

}  // namespace engram::ltm
