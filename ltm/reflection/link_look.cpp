// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "ltm/reflection/looks.h"
#include "ltm/reflection/robust.h"

namespace engram::ltm {

namespace {

constexpr size_t kMinLinks = 20;
/// Share of links that lead to the usual distance where there is one.
constexpr double kUsualLinkShare = 0.85;

std::string distance_text(double seconds) {
  if (std::abs(seconds) < 5e-7) return "the same time";
  return fmt::format("{:.4g} s {}", std::abs(seconds), seconds < 0 ? "before" : "after");
}

void find_dead(const SeriesBlock& block, const LinkColumn& column, EntityReflection& entity,
               FindingList& findings) {
  using State = LinkTarget::State;
  entity.looked_at.insert({ReflectionKind::kDeadLink, ReflectionKind::kForeignLink});
  size_t text = 0;
  for (size_t i = 0; i < column.rows.size(); ++i) {
    const LinkTarget& target = column.targets[i];
    if (target.state == State::kFound) continue;
    while (text < column.dead.size() && column.dead[text].first < column.rows[i]) ++text;
    const bool has_text = text < column.dead.size() && column.dead[text].first == column.rows[i];
    const std::string where = has_text ? column.dead[text].second : "a snapshot";
    const Time time = time_from_ns(block.times[column.rows[i]]);
    const bool is_foreign = target.state == State::kForeign;
    ReflectionFinding finding{
        is_foreign ? ReflectionKind::kForeignLink : ReflectionKind::kDeadLink,
        is_foreign || target.state == State::kForgotten ? Severity::kNote : Severity::kFault,
        block.entity,
        column.path,
        time,
        time};
    finding.found = fmt::format("a link to {}", where);
    finding.expected = target.state == State::kForgotten  ? "a snapshot that was not forgotten"
                       : target.state == State::kBroken   ? "the ID of an entity or of a snapshot"
                       : is_foreign                       ? "a core segment that the store has"
                       : target.state == State::kNoEntity ? "an entity that the store has"
                                                          : "a time at which it has a snapshot";
    findings.add(std::move(finding), is_foreign ? Duration::max() / 4 : std::chrono::seconds(1));
  }
}

void find_odd_times(const SeriesBlock& block, const LinkColumn& column, EntityReflection& entity,
                    FindingList& findings) {
  std::vector<double> distances, sample;
  for (size_t i = 0; i < column.rows.size(); ++i) {
    const LinkTarget& target = column.targets[i];
    const int64_t own = block.times[column.rows[i]];
    distances.push_back(target.has_time ? 1e-9 * static_cast<double>(target.time_ns - own) : NAN);
    if (target.has_time) sample.push_back(distances.back());
  }
  if (sample.size() < kMinLinks) return;
  sample = spread_sample(sample);
  const double usual = quantile(sample, 0.5);
  std::vector<double> away;
  for (const double distance : sample) away.push_back(std::abs(distance - usual));
  const double near = std::max({1e-3, 6 * quantile(away, 0.5), 0.25 * block.step_s});
  const auto usual_count = std::ranges::count_if(away, [near](double d) { return d <= near; });
  // Links to what was said once, or to the begin of something, have no usual distance.
  if (static_cast<double>(usual_count) < kUsualLinkShare * static_cast<double>(away.size()) ||
      near > 5)
    return;
  entity.looked_at.insert(ReflectionKind::kLinkTime);
  for (size_t i = 0; i < distances.size(); ++i) {
    if (std::isnan(distances[i]) || std::abs(distances[i] - usual) <= near) continue;
    const Time time = time_from_ns(block.times[column.rows[i]]);
    findings.add({ReflectionKind::kLinkTime, Severity::kFault, block.entity, column.path, time,
                  time, 1, "a link to " + distance_text(distances[i]), distance_text(usual)});
  }
}

}  // namespace

void look_at_links(const SeriesBlock& block, EntityReflection& entity, FindingList& findings) {
  for (const LinkColumn& column : block.links) {
    if (column.rows.empty()) continue;
    find_dead(block, column, entity, findings);
    if (block.is_periodic) find_odd_times(block, column, entity, findings);
  }
}

}  // namespace engram::ltm
