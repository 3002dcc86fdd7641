// SPDX-License-Identifier: Apache-2.0
#include "server/access/grants.h"

#include <algorithm>
#include <array>
#include <string>

#include "ltm/memory/score_id.h"

namespace engram::server {

using ltm::MemoryId;

namespace {

constexpr std::string_view kAllIds = "all";
constexpr std::array kRights{Right::kRead, Right::kModels, Right::kWrite, Right::kErase};
constexpr std::string_view kRightNames = "read, models, write or erase";

bool has(const std::vector<Right>& rights, Right right) {
  return std::ranges::find(rights, right) != rights.end();
}

Result<std::vector<Right>> read_role(const ConfigValue& config) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
  if (text == "read") return std::vector{Right::kRead, Right::kModels};
  if (text == "write") return std::vector{Right::kRead, Right::kModels, Right::kWrite};
  if (text == "admin") return std::vector(kRights.begin(), kRights.end());
  return config.error(fmt::format("found '{}', needs read, write or admin", text));
}

Result<Right> read_right(const ConfigValue& config) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
  for (const Right right : kRights)
    if (text == to_string(right)) return right;
  return config.error(fmt::format("found '{}', needs {}", text, kRightNames));
}

Result<std::vector<Right>> read_rights(const ConfigValue& config) {
  std::vector<Right> rights;
  ENGRAM_ASSIGN_OR_RETURN(const auto list, config.list());
  for (const ConfigValue& value : list) {
    ENGRAM_ASSIGN_OR_RETURN(const Right right, read_right(value));
    rights.push_back(right);
  }
  if (rights.empty())
    return config.error(fmt::format("found an empty list, needs {}", kRightNames));
  return rights;
}

Result<MemoryId> read_prefix(const ConfigValue& config) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
  auto id = MemoryId::parse(text);
  if (!id.ok()) return config.error(id.status());
  if (id->names().empty() || id->time())
    return config.error(fmt::format("found '{}', needs a memory, segment or entity", text));
  return id;
}

Result<std::vector<MemoryId>> read_ids(const ConfigValue& config) {
  if (config.is_text()) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
    if (text == kAllIds) return std::vector{MemoryId()};
    return config.error(fmt::format("found '{}', needs a list of IDs, or 'all'", text));
  }
  std::vector<MemoryId> ids;
  ENGRAM_ASSIGN_OR_RETURN(const auto list, config.list());
  for (const ConfigValue& value : list) {
    ENGRAM_ASSIGN_OR_RETURN(MemoryId prefix, read_prefix(value));
    ids.push_back(std::move(prefix));
  }
  if (ids.empty()) return config.error("found an empty list, needs IDs, or 'all'");
  return ids;
}

/// Reads `from` and `until`, or `last`. Returns whether any of them is there.
Result<bool> read_window(ConfigMap& map, Grant& grant) {
  bool is_there = false;
  for (const auto& [key, time] :
       {std::pair{"from", &grant.window.first}, std::pair{"until", &grant.window.last}})
    if (const auto config = map.find(key)) {
      ENGRAM_ASSIGN_OR_RETURN(*time, read_time(*config));
      is_there = true;
    }
  if (grant.window.last < grant.window.first)
    return map.value().error(fmt::format("found 'until' {}, needs it after 'from' {}",
                                         engram::to_string(grant.window.last),
                                         engram::to_string(grant.window.first)));
  if (const auto last = map.find("last")) {
    if (is_there) return last->error("stands beside 'from' or 'until', needs to stand alone");
    ENGRAM_ASSIGN_OR_RETURN(grant.last, last->duration());
    is_there = true;
  }
  return is_there;
}

Result<Grant> read_grant(const ConfigValue& config) {
  Grant grant;
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, config.map());
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue ids, map.require("ids"));
  ENGRAM_ASSIGN_OR_RETURN(grant.ids, read_ids(ids));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue may, map.require("may"));
  ENGRAM_ASSIGN_OR_RETURN(grant.may, read_rights(may));
  ENGRAM_ASSIGN_OR_RETURN(const bool has_window, read_window(map, grant));
  if (const auto form = map.find("form")) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string text, form->text());
    if (text != "exact" && text != "redacted")
      return form->error(fmt::format("found '{}', needs exact or redacted", text));
    grant.is_redacted = text == "redacted";
    if (grant.is_redacted && grant.may != std::vector{Right::kRead})
      return form->error("found redacted beside other rights than read, needs a grant of its own");
  }
  ENGRAM_RETURN_IF_ERROR(map.finish());
  if (has(grant.may, Right::kModels)) {
    if (!has(grant.may, Right::kRead))
      return may.error("found models without read, needs both: a prediction tells of the past");
    if (has_window)
      return may.error(
          "found models beside 'from', 'until' or 'last': what they learned from has all times, so "
          "needs a grant of all times");
  }
  return grant;
}

}  // namespace

Result<Time> read_time(const ConfigValue& config) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
  auto time = parse_time(text);
  if (!time.ok()) return config.error(time.status());
  return time;
}

std::string_view to_string(Right right) {
  switch (right) {
    case Right::kRead:
      return "read";
    case Right::kModels:
      return "models";
    case Right::kWrite:
      return "write";
    case Right::kErase:
      break;
  }
  return "erase";
}

bool Grant::gives(Right right, const MemoryId& id) const {
  return has(may, right) &&
         std::ranges::any_of(ids, [&](const MemoryId& prefix) { return prefix.is_prefix_of(id); });
}

ltm::TimeWindows::Window Grant::window_at(Time now) const {
  if (!last) return window;
  int64_t first = 0;
  if (__builtin_sub_overflow(to_ns(now), last->count(), &first)) first = INT64_MIN;
  return {.first = time_from_ns(first)};
}

Grants Grants::all() {
  Grants grants;
  grants.grants_.push_back({{MemoryId()}, {kRights.begin(), kRights.end()}, {}, {}});
  return grants;
}

Result<Grants> Grants::read(ConfigMap& token) {
  Grants grants;
  const auto list = token.find("grants");
  if (list) {
    for (const char* other : {"role", "memories"})
      if (const auto found = token.find(other))
        return found->error("stands beside 'grants', needs one of the two");
    ENGRAM_ASSIGN_OR_RETURN(const auto values, list->list());
    if (values.empty() || values.size() > kMaxGrants)
      return list->error(fmt::format("found {} grants, needs 1 to {}", values.size(), kMaxGrants));
    for (const ConfigValue& value : values) {
      ENGRAM_ASSIGN_OR_RETURN(Grant grant, read_grant(value));
      grants.grants_.push_back(std::move(grant));
    }
    return grants;
  }
  Grant grant;
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue role, token.require("role"));
  ENGRAM_ASSIGN_OR_RETURN(grant.may, read_role(role));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue memories, token.require("memories"));
  ENGRAM_ASSIGN_OR_RETURN(grant.ids, read_ids(memories));
  grants.grants_.push_back(std::move(grant));
  return grants;
}

bool Grants::give_below(Right right, const MemoryId& id) const {
  return give(right, id) || std::ranges::any_of(grants_, [&](const Grant& grant) {
           return has(grant.may, right) && std::ranges::any_of(grant.ids, [&](const MemoryId& of) {
                    return id.is_prefix_of(of);
                  });
         });
}

bool Grants::give(Right right, const MemoryId& id) const {
  return std::ranges::any_of(grants_, [&](const Grant& grant) { return grant.gives(right, id); });
}

ltm::TimeWindows Grants::times(Right right, const MemoryId& id, Time now) const {
  ltm::TimeWindows times;
  for (const Grant& grant : grants_)
    if (grant.gives(right, id)) times.add(grant.window_at(now));
  return times;
}

bool Grants::redact() const {
  return std::ranges::any_of(grants_, [](const Grant& grant) { return grant.is_redacted; });
}

ltm::Sight Grants::sight_of(const MemoryId& entity, Time now) const {
  // A score tells of an entity at times of its past and future.
  if (const auto scored = ltm::scored_entity(entity); scored && !sight_of(*scored, now).is_all())
    return {};
  ltm::Sight sight{{}, {}, give(Right::kModels, entity)};
  for (const Grant& grant : grants_) {
    if (!grant.gives(Right::kRead, entity)) continue;
    sight.times.add(grant.window_at(now));
    if (!grant.is_redacted) sight.exact.add(grant.window_at(now));
  }
  // Without redaction the two are equal, and no snapshot has to be looked at.
  if (!redact()) sight.exact = ltm::TimeWindows::all();
  return sight;
}

}  // namespace engram::server
