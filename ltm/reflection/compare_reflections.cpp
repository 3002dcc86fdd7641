// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/compare_reflections.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace engram::ltm {

namespace {

constexpr double kOtherRate = 1.1;     ///< Rates that differ by this factor.
constexpr double kOtherSpeed = 1.5;    ///< The same of speeds.
constexpr double kOtherMiddle = 0.01;  ///< Medians that differ by this share of the member.
constexpr double kOtherIdle = 0.2;     ///< Shares of idle time that differ by so much.

class Comparison {
 public:
  Comparison(const Reflection& here, const Reflection& there) : here_(here), there_(there) {}

  std::vector<ReflectionDifference> run() {
    for (const EntityReflection& entity : here_.entities)
      if (const EntityReflection* other = find(there_, entity.id))
        compare(entity, *other);
      else
        add(entity.id.to_string(), "entity", "is there", "is missing");
    for (const EntityReflection& entity : there_.entities)
      if (find(here_, entity.id) == nullptr)
        add(entity.id.to_string(), "entity", "is missing", "is there");
    for (const SkillReflection& skill : here_.skills) compare(skill);
    compare_findings();
    return std::move(differences_);
  }

 private:
  static const EntityReflection* find(const Reflection& in, const MemoryId& id) {
    const auto found = std::ranges::find(in.entities, id, &EntityReflection::id);
    return found == in.entities.end() ? nullptr : &*found;
  }

  static bool is_factor(double a, double b, double factor) {
    return a > 0 && b > 0 && std::max(a, b) > factor * std::min(a, b);
  }

  void add(std::string object, std::string what, std::string here, std::string there) {
    differences_.push_back({std::move(object), std::move(what), std::move(here), std::move(there)});
  }

  void compare(const EntityReflection& a, const EntityReflection& b) {
    const std::string name = a.id.to_string();
    if (is_factor(a.median_step_s, b.median_step_s, kOtherRate))
      add(name, "rate", fmt::format("{:.3g} Hz", 1 / a.median_step_s),
          fmt::format("{:.3g} Hz", 1 / b.median_step_s));
    if (a.is_periodic != b.is_periodic)
      add(name, "rate", a.is_periodic ? "steady" : "not steady",
          b.is_periodic ? "steady" : "not steady");
    if (a.has_motion && b.has_motion && std::abs(a.idle_share - b.idle_share) > kOtherIdle)
      add(name, "idle time", fmt::format("{:.0f} %", 100 * a.idle_share),
          fmt::format("{:.0f} %", 100 * b.idle_share));
    const bool do_both_move = a.has_motion && b.has_motion && a.idle_share < 1 && b.idle_share < 1;
    for (const MemberReflection& member : a.members)
      for (const MemberReflection& other : b.members)
        if (member.path == other.path) compare(name, member, other, do_both_move);
  }

  void compare(const std::string& entity, const MemberReflection& a, const MemberReflection& b,
               bool do_both_move) {
    if (a.middle.size() != b.middle.size()) {
      add(entity, a.path, fmt::format("{} numbers", a.middle.size()),
          fmt::format("{} numbers", b.middle.size()));
      return;
    }
    double size = 0;  // Of the member: what is small beside it is noise.
    for (size_t k = 0; k < a.middle.size(); ++k)
      size = std::max({size, std::abs(a.middle[k]), std::abs(b.middle[k])});
    for (size_t k = 0; k < a.middle.size(); ++k) {
      if (a.low[k] <= b.high[k] && b.low[k] <= a.high[k]) continue;
      if (std::abs(a.middle[k] - b.middle[k]) < kOtherMiddle * size) continue;
      add(entity, a.middle.size() == 1 ? a.path : fmt::format("{}[{}]", a.path, k),
          fmt::format("{:.4g} to {:.4g}", a.low[k], a.high[k]),
          fmt::format("{:.4g} to {:.4g}", b.low[k], b.high[k]));
    }
    if (do_both_move && is_factor(a.speed, b.speed, kOtherSpeed))
      add(entity, a.path + ", speed", fmt::format("{:.3g} per s", a.speed),
          fmt::format("{:.3g} per s", b.speed));
  }

  void compare(const SkillReflection& skill) {
    for (const SkillReflection& other : there_.skills) {
      if (other.skill != skill.skill) continue;
      for (const SuccessRate& a : skill.rates)
        for (const SuccessRate& b : other.rates) {
          if (a.by != b.by || a.name != b.name || (a.low <= b.high && b.low <= a.high)) continue;
          const auto text = [](const SuccessRate& rate) {
            return fmt::format("{} of {}", rate.successes, rate.runs);
          };
          add("skill " + skill.skill,
              a.by == "all" ? "success" : "success by " + a.by + " " + a.name, text(a), text(b));
        }
    }
  }

  void compare_findings() {
    std::map<std::pair<std::string, ReflectionKind>, std::pair<uint64_t, uint64_t>> counts;
    for (const ReflectionFinding& finding : here_.findings)
      ++counts[{finding.entity.to_string(), finding.kind}].first;
    for (const ReflectionFinding& finding : there_.findings)
      ++counts[{finding.entity.to_string(), finding.kind}].second;
    for (const auto& [key, count] : counts)
      if (count.first != count.second)
        add(key.first, std::string(to_string(key.second)), fmt::format("{} findings", count.first),
            fmt::format("{} findings", count.second));
  }

  const Reflection& here_;
  const Reflection& there_;
  std::vector<ReflectionDifference> differences_;
};

}  // namespace

std::vector<ReflectionDifference> compare_reflections(const Reflection& here,
                                                      const Reflection& there) {
  return Comparison(here, there).run();
}

}  // namespace engram::ltm
