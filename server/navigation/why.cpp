// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/why.h"

#include <algorithm>
#include <array>

#include "ltm/core/printable.h"
#include "server/navigation/plan_check.h"

namespace engram::navigation {

namespace {

constexpr std::array<std::string_view, 6> kLeadingMembers{"plan",    "request", "cause",
                                                          "command", "task",    "trigger"};
/// What values call what they are about, the most telling first.
constexpr std::array<std::string_view, 5> kTellingMembers{"text", "reason", "goal", "skill",
                                                          "name"};

std::optional<ltm::MemoryId> snapshot_link(const idf::Data& value, std::string_view member) {
  const idf::Data* found = value.at(member);
  const auto* text = found == nullptr ? nullptr : found->get_if<std::string>();
  if (text == nullptr || text->empty()) return {};
  const auto id = ltm::MemoryId::parse(*text);
  if (!id.ok() || !id->has_entity() || !id->time()) return {};
  return *id;
}

std::string told_by(const idf::Data& value) {
  for (const std::string_view member : kTellingMembers) {
    const idf::Data* found = value.at(member);
    const auto* text = found == nullptr ? nullptr : found->get_if<std::string>();
    if (text != nullptr && !text->empty()) return *text;
  }
  return {};
}

}  // namespace

Result<std::vector<WhyStep>> why(Memory& memory, const ltm::MemoryId& snapshot) {
  constexpr size_t kMaxSteps = 16;
  std::vector<WhyStep> steps;
  ltm::MemoryId id = snapshot;
  std::string member;
  while (steps.size() < kMaxSteps) {
    const auto value = value_at(memory, id);
    if (!value.ok() && (steps.empty() || value.status().code() != StatusCode::kNotFound))
      return value.status();
    // What was forgotten is named all the same.
    steps.push_back({id, member, value.ok() ? told_by(*value) : "the memory has it no more"});
    if (!value.ok()) break;
    std::optional<ltm::MemoryId> next;
    for (const std::string_view leading : kLeadingMembers) {
      next = snapshot_link(*value, leading);
      member = leading;
      // A command that names the drive that it led to must not lead in circles.
      const bool is_known =
          next && std::any_of(steps.begin(), steps.end(),
                              [&](const WhyStep& step) { return step.id == *next; });
      if (is_known) next.reset();
      if (next) break;
    }
    if (!next) break;
    id = *next;
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
