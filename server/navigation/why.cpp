// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/why.h"

#include <algorithm>
#include <array>
#include <optional>

#include "ltm/core/printable.h"
#include "server/navigation/plan_check.h"

namespace engram::navigation {

namespace {

/// The request of a skill has `causes`.
constexpr std::array<std::string_view, 7> kLeadingMembers{"plan",    "request", "cause",  "causes",
                                                          "command", "task",    "trigger"};
/// What values call what they are about, the most telling first.
constexpr std::array<std::string_view, 5> kTellingMembers{"text", "reason", "goal", "skill",
                                                          "name"};

std::optional<ltm::MemoryId> snapshot_named(const idf::Data& value) {
  const auto* text = value.get_if<std::string>();
  if (text == nullptr || text->empty()) return {};
  const auto id = ltm::MemoryId::parse(*text);
  if (!id.ok() || !id->has_entity() || !id->time()) return {};
  return *id;
}

/// The link of a member, or the first valid one of a list.
std::optional<ltm::MemoryId> snapshot_link(const idf::Data& value, std::string_view member) {
  const idf::Data* found = value.at(member);
  if (found == nullptr) return {};
  const auto* list = found->get_if<idf::List>();
  if (list == nullptr) return snapshot_named(*found);
  for (const idf::Data& one : *list)
    if (auto id = snapshot_named(one)) return id;
  return {};
}

/// A link, and the member that it was found in.
struct WhyLink {
  ltm::MemoryId id;
  std::string member;
};

bool is_told(const std::vector<WhyStep>& steps, const ltm::MemoryId& id) {
  return std::any_of(steps.begin(), steps.end(),
                     [&](const WhyStep& step) { return step.id == id; });
}

/// Where a value leads on. A command that names the drive that it led to must not lead in circles.
std::optional<WhyLink> leading_link(const idf::Data& value, const std::vector<WhyStep>& steps) {
  for (const std::string_view member : kLeadingMembers)
    if (const auto id = snapshot_link(value, member); id && !is_told(steps, *id))
      return WhyLink{*id, std::string(member)};
  return {};
}

std::string told_by(const idf::Data& value) {
  for (const std::string_view member : kTellingMembers) {
    const idf::Data* found = value.at(member);
    const auto* text = found == nullptr ? nullptr : found->get_if<std::string>();
    if (text != nullptr && !text->empty()) return *text;
  }
  return {};
}

/// The last snapshot of an entity that names no time.
Result<ltm::MemoryId> with_time(Memory& memory, const ltm::MemoryId& id) {
  if (!id.has_entity()) return id;
  // As links name it, so that a circle of them is seen.
  if (id.time()) return id.index() ? id : id.instance(0);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found,
                          memory.query(ltm::Query::of_entity(id, ltm::select::Latest{})));
  const ltm::EntityResult* entity = found.find_entity(id);
  if (entity == nullptr || entity->snapshots.empty())
    return not_found("the memory has no '{}'", id.printable());
  return id.at(entity->snapshots.back().time).instance(0);
}

}  // namespace

Result<std::vector<WhyStep>> why(Memory& memory, const ltm::MemoryId& id) {
  constexpr size_t kMaxSteps = 16;
  std::vector<WhyStep> steps;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId snapshot, with_time(memory, id));
  std::optional<WhyLink> next = WhyLink{snapshot, {}};
  // The cause beside the request that was followed last: a request need not tell its own.
  std::optional<ltm::MemoryId> cause_beside;
  while (next && steps.size() < kMaxSteps) {
    const auto value = value_at(memory, next->id);
    if (!value.ok() && (steps.empty() || value.status().code() != StatusCode::kNotFound))
      return value.status();
    // What was forgotten is named all the same.
    steps.push_back(
        {next->id, next->member, value.ok() ? told_by(*value) : "the memory has it no more"});
    next = value.ok() ? leading_link(*value, steps) : std::nullopt;
    if (!next && cause_beside && !is_told(steps, *cause_beside))
      next = WhyLink{*cause_beside, "cause"};
    cause_beside = next && value.ok() && next->member == "request" ? snapshot_link(*value, "cause")
                                                                   : std::nullopt;
  }
  return steps;
}

std::string why_text(const std::vector<WhyStep>& steps) {
  std::string text;
  for (const WhyStep& step : steps) {
    text += step.member.empty() ? std::string() : fmt::format("because of its {}: ", step.member);
    text += step.id.printable();
    if (!step.says.empty()) text += fmt::format(" ({})", printable(step.says));
    text += '\n';
  }
  return text;
}

}  // namespace engram::navigation
