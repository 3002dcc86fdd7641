// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/reflection_text.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

#include "ltm/core/printable.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

/// Entities that are told one by one, unless somebody wants all of them.
constexpr size_t kMaxReflectedEntities = 100;

Json json_of(const ltm::ReflectionFinding& finding) {
  return {{"kind", to_string(finding.kind)},
          {"severity", to_string(finding.severity)},
          {"entity", finding.entity.to_string()},
          {"member", finding.member},
          {"first", to_string(finding.first)},
          {"last", to_string(finding.last)},
          {"first_ns", to_ns(finding.first)},
          {"last_ns", to_ns(finding.last)},
          {"count", finding.count},
          {"found", finding.found},
          {"expected", finding.expected}};
}

Json json_of(const ltm::MemberReflection& member) {
  Json json{{"path", member.path},
            {"unit", member.unit},
            {"low", member.low},
            {"middle", member.middle},
            {"high", member.high}};
  if (member.is_motion) {
    json["speed"] = member.speed;
    json["jerk"] = member.jerk;
  }
  return json;
}

Json json_of(const ltm::EntityReflection& entity) {
  Json json{{"id", entity.id.to_string()},
            {"snapshots", entity.snapshots},
            {"first_ns", to_ns(entity.first)},
            {"last_ns", to_ns(entity.last)},
            {"is_periodic", entity.is_periodic}};
  if (entity.is_periodic) {
    json["rate_hz"] = 1 / entity.median_step_s;
    json["missing"] = entity.missing;
    json["gap_s"] = entity.gap_s;
  }
  if (entity.has_motion) {
    json["idle_share"] = entity.idle_share;
    json["longest_idle_s"] = entity.longest_idle_s;
  }
  if (entity.latency_s) json["latency_s"] = *entity.latency_s;
  json["looked_at"] = Json::array();
  for (const ltm::ReflectionKind kind : entity.looked_at)
    json["looked_at"].push_back(to_string(kind));
  json["members"] = Json::array();
  for (const ltm::MemberReflection& member : entity.members)
    json["members"].push_back(json_of(member));
  return json;
}

Json json_of(const ltm::SkillReflection& skill) {
  Json rates = Json::array();
  for (const ltm::SuccessRate& rate : skill.rates)
    rates.push_back({{"by", rate.by},
                     {"name", rate.name},
                     {"runs", rate.runs},
                     {"successes", rate.successes},
                     {"failures", rate.failures},
                     {"stops", rate.stops},
                     {"low", rate.low},
                     {"high", rate.high},
                     {"duration_s", rate.mean_duration_s}});
  return {{"skill", skill.skill}, {"unfinished", skill.unfinished}, {"rates", std::move(rates)}};
}

std::string counted(uint64_t count, const char* one, const char* several) {
  return fmt::format("{} {}", count_text(count), count == 1 ? one : several);
}

/// "08:00:05.46 to 08:00:05.75", with the day and fewer digits where a span is long.
std::string span_text(Time first, Time last) {
  const std::string from = to_string(first), to = to_string(last);
  constexpr size_t kDay = 11, kHundredths = 22;
  if (first == last) return from.substr(0, kHundredths + 1);
  if (from.substr(0, kDay) != to.substr(0, kDay))
    return from.substr(0, kHundredths) + " to " + to.substr(0, kHundredths);
  return from.substr(0, kHundredths) + " to " + to.substr(kDay, kHundredths - kDay);
}

/// Whether the number of snapshots is not in the text already.
bool is_repeated(const ltm::ReflectionFinding& finding) {
  using Kind = ltm::ReflectionKind;
  constexpr std::array<Kind, 5> kCounted{Kind::kRate, Kind::kFrozen, Kind::kDuplicate, Kind::kDrift,
                                         Kind::kClockDrift};
  return finding.count > 1 && std::ranges::find(kCounted, finding.kind) == kCounted.end();
}

void print_finding(const ltm::ReflectionFinding& finding) {
  print(fmt::format("{:5}  {:13}  {}", to_string(finding.severity), to_string(finding.kind),
                    span_text(finding.first, finding.last)));
  print(fmt::format("       {}{}{}", finding.entity.printable(), finding.member.empty() ? "" : "  ",
                    printable(finding.member)));
  print(
      fmt::format("       found {}{}, needs {}\n", printable(finding.found),
                  is_repeated(finding) ? fmt::format(" ({} times)", count_text(finding.count)) : "",
                  printable(finding.expected)));
}

/// How many findings of which kind each entity has.
void print_counts(const std::vector<ltm::ReflectionFinding>& findings) {
  std::map<std::pair<ltm::MemoryId, ltm::ReflectionKind>, uint64_t> counts;
  for (const ltm::ReflectionFinding& finding : findings) ++counts[{finding.entity, finding.kind}];
  TextTable table({"entity", "kind", "findings"});
  for (const auto& [key, count] : counts)
    table.add({key.first.printable(), std::string(to_string(key.second)), count_text(count)});
  print(table.to_string());
}

void print_entities(const ltm::Reflection& reflection, bool are_all) {
  TextTable table({"entity", "snapshots", "rate", "missing", "gaps", "idle", "findings"});
  std::map<ltm::MemoryId, uint64_t> findings;
  for (const ltm::ReflectionFinding& finding : reflection.findings) ++findings[finding.entity];
  size_t told = 0, once = 0;
  for (const ltm::EntityReflection& entity : reflection.entities) {
    const uint64_t found = findings[entity.id];
    if (entity.snapshots <= 1 && found == 0) {
      ++once;
      continue;
    }
    if (!are_all && found == 0 && told >= kMaxReflectedEntities) continue;
    ++told;
    const bool is_steady = entity.is_periodic;
    table.add({entity.id.printable(), count_text(entity.snapshots),
               is_steady ? fmt::format("{:.3g} Hz", 1 / entity.median_step_s) : "events",
               is_steady ? count_text(entity.missing) : "-",
               is_steady && entity.gap_s > 0 ? seconds_text(entity.gap_s) : "-",
               entity.has_motion ? fmt::format("{:.0f} %", 100 * entity.idle_share) : "-",
               found == 0 ? "-" : count_text(found)});
  }
  if (told > 0) print(table.to_string());
  const size_t left = reflection.entities.size() - told - once;
  if (once > 0) print(fmt::format("{} more entities have one snapshot each.", once));
  if (left > 0) print(fmt::format("{} more entities without findings: --all tells of each.", left));
  print("");
}

void print_skills(const ltm::Reflection& reflection) {
  if (reflection.skills.empty()) return;
  TextTable table({"skill", "success", "of", "95 % interval", "stopped", "duration"});
  for (const ltm::SkillReflection& skill : reflection.skills)
    for (const ltm::SuccessRate& rate : skill.rates) {
      const bool is_all = rate.by == "all";
      if (!is_all && rate.name == "-") continue;
      table.add({is_all ? skill.skill : fmt::format("  {} {}", rate.by, rate.name),
                 rate.runs == 0
                     ? "-"
                     : fmt::format("{:.0f} %", 100.0 * static_cast<double>(rate.successes) /
                                                   static_cast<double>(rate.runs)),
                 count_text(rate.runs),
                 fmt::format("{:.0f} to {:.0f} %", 100 * rate.low, 100 * rate.high),
                 rate.stops == 0 ? "-" : count_text(rate.stops),
                 rate.runs == 0 ? "-" : fmt::format("{:.3g} s", rate.mean_duration_s)});
    }
  print(table.to_string());
  print("");
  if (reflection.chains.empty()) return;
  print("What follows a failure or a stop:");
  for (const ltm::FailureChain& chain : reflection.chains) {
    std::string steps;
    for (const std::string& step : chain.steps)
      steps += (steps.empty() ? "" : " -> ") + printable(step);
    print(fmt::format("  {} x  {}", chain.count, steps));
  }
  print("");
}

}  // namespace

Json differences_json(const std::vector<ltm::ReflectionDifference>& differences) {
  Json json = Json::array();
  for (const ltm::ReflectionDifference& difference : differences)
    json.push_back({{"object", difference.object},
                    {"what", difference.what},
                    {"here", difference.here},
                    {"there", difference.there}});
  return json;
}

Json reflection_json(const ltm::Reflection& reflection) {
  Json json{{"store", reflection.store},
            {"snapshots", reflection.snapshots},
            {"looks", reflection.looks},
            {"faults", reflection.count(ltm::Severity::kFault)},
            {"notes", reflection.count(ltm::Severity::kNote)},
            {"untold", reflection.untold}};
  for (const char* list : {"findings", "entities", "skills", "chains", "shifts"})
    json[list] = Json::array();
  for (const auto& finding : reflection.findings) json["findings"].push_back(json_of(finding));
  for (const auto& entity : reflection.entities) json["entities"].push_back(json_of(entity));
  for (const auto& skill : reflection.skills) json["skills"].push_back(json_of(skill));
  for (const auto& chain : reflection.chains)
    json["chains"].push_back({{"steps", chain.steps}, {"count", chain.count}});
  for (const auto& shift : reflection.shifts)
    json["shifts"].push_back({{"entity", shift.entity.to_string()},
                              {"other", shift.other.to_string()},
                              {"shift_s", shift.shift_s},
                              {"correlation", shift.correlation}});
  return json;
}

void print_reflection(const ltm::Reflection& reflection, const ReflectionTextOptions& options) {
  print_entities(reflection, options.are_all_entities);
  print_skills(reflection);
  const size_t all = reflection.findings.size();
  const size_t told = options.max_findings == 0 ? all : std::min(all, options.max_findings);
  for (size_t i = 0; i < told; ++i) print_finding(reflection.findings[i]);
  if (told < all) {
    print(fmt::format("And {} more; --findings 0 tells of each. All of them:", all - told));
    print_counts(reflection.findings);
    print("");
  }
  if (reflection.untold > 0)
    print(fmt::format("{} further findings repeat these and are not told.",
                      count_text(reflection.untold)));
  print(fmt::format("{}: {} and {} in {} of {}.", printable(reflection.store),
                    counted(reflection.count(ltm::Severity::kFault), "fault", "faults"),
                    counted(reflection.count(ltm::Severity::kNote), "note", "notes"),
                    counted(reflection.snapshots, "snapshot", "snapshots"),
                    counted(reflection.entities.size(), "entity", "entities")));
}

void print_differences(const std::vector<ltm::ReflectionDifference>& differences,
                       const std::string& here, const std::string& there) {
  if (differences.empty()) {
    print(fmt::format("\n{} and {} do not differ in what is usual.", printable(here),
                      printable(there)));
    return;
  }
  print("\nAgainst " + printable(there) + ":");
  TextTable table({"object", "what", "here", "there"});
  for (const ltm::ReflectionDifference& difference : differences)
    table.add({difference.object, difference.what, difference.here, difference.there});
  print(table.to_string());
}

}  // namespace engram::reports
