// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/reflection.h"

#include <algorithm>
#include <array>
#include <utility>

namespace engram::ltm {

namespace {

constexpr std::array<std::pair<ReflectionKind, std::string_view>, 16> kReflectionNames{{
    {ReflectionKind::kGap, "gap"},
    {ReflectionKind::kRate, "rate"},
    {ReflectionKind::kOutOfBounds, "out-of-bounds"},
    {ReflectionKind::kNotFinite, "not-finite"},
    {ReflectionKind::kFrozen, "frozen"},
    {ReflectionKind::kDuplicate, "duplicate"},
    {ReflectionKind::kSpike, "spike"},
    {ReflectionKind::kJump, "jump"},
    {ReflectionKind::kDrift, "drift"},
    {ReflectionKind::kClockDrift, "clock-drift"},
    {ReflectionKind::kDeadLink, "dead-link"},
    {ReflectionKind::kForeignLink, "foreign-link"},
    {ReflectionKind::kLinkTime, "link-time"},
    {ReflectionKind::kTimeShift, "time-shift"},
    {ReflectionKind::kBrokenAction, "broken-action"},
    {ReflectionKind::kUnreadable, "unreadable"},
}};

}  // namespace

const std::vector<ReflectionKind>& all_reflection_kinds() {
  static const std::vector<ReflectionKind> kinds = [] {
    std::vector<ReflectionKind> all;
    for (const auto& [kind, name] : kReflectionNames) all.push_back(kind);
    return all;
  }();
  return kinds;
}

std::string_view to_string(ReflectionKind kind) {
  return kReflectionNames[static_cast<size_t>(kind)].second;
}

std::string_view to_string(Severity severity) {
  return severity == Severity::kFault ? "fault" : "note";
}

uint64_t Reflection::count(Severity severity) const {
  return static_cast<uint64_t>(
      std::ranges::count(findings, severity, &ReflectionFinding::severity));
}

}  // namespace engram::ltm
