// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "ltm/idf/type_check.h"
#include "ltm/reflection/looks.h"

namespace engram::ltm {

namespace {

/// Share of numbers within described limits from which on they are meant for a member.
constexpr double kWithinShare = 0.9;
/// By how much described limits may be passed, as a share of their range.
constexpr double kLimitSlack = 0.01;

ReflectionFinding number_finding(const SeriesBlock& block, ReflectionKind kind,
                                 const NumberColumn& column, size_t index, size_t element) {
  const Time time = time_from_ns(block.times[column.rows[index]]);
  ReflectionFinding finding{
      kind, Severity::kFault, block.entity, column.element_name(element), time, time};
  finding.found = fmt::format("{:.6g}", column.at(index, element));
  return finding;
}

void look_at_numbers(const SeriesBlock& block, const NumberColumn& column, FindingList& findings) {
  const double low = column.minimum.value_or(-INFINITY), high = column.maximum.value_or(INFINITY);
  const std::string needed =
      fmt::format("{:.6g} to {:.6g}{}{}", low, high, column.unit.empty() ? "" : " ", column.unit);
  for (size_t i = 0; i < column.values.size(); ++i) {
    const double value = column.values[i];
    if (std::isfinite(value) && value >= low && value <= high) continue;
    const auto kind =
        std::isfinite(value) ? ReflectionKind::kOutOfBounds : ReflectionKind::kNotFinite;
    auto finding =
        number_finding(block, kind, column, i % column.rows.size(), i / column.rows.size());
    finding.expected = std::isfinite(value) ? needed : "a number";
    findings.add(std::move(finding));
  }
}

void look_at_norms(const SeriesBlock& block, const NumberColumn& column, FindingList& findings) {
  for (size_t i = 0; i < column.rows.size(); ++i) {
    double sum = 0;
    for (size_t k = 0; k < column.width; ++k) sum += column.at(i, k) * column.at(i, k);
    if (!std::isfinite(sum) || std::abs(std::sqrt(sum) - 1) <= 2 * idf::kUnitTolerance) continue;
    auto finding = number_finding(block, ReflectionKind::kOutOfBounds, column, i, 0);
    finding.member = column.path;
    finding.found = fmt::format("a norm of {:.6g}", std::sqrt(sum));
    finding.expected = "an orientation of norm 1";
    findings.add(std::move(finding));
  }
}

const NumberColumn* column_named(const SeriesBlock& block, std::string_view name) {
  for (const NumberColumn& column : block.numbers)
    if (column.path == name && !column.rows.empty()) return &column;
  return nullptr;
}

bool is_position(const std::string& path) {
  const std::vector<std::string> names = idf::split_path(path);
  return !names.empty() && (names.back() == "positions" || names.back() == "position");
}

}  // namespace

void look_at_bounds(const SeriesBlock& block, EntityReflection& entity, FindingList& findings) {
  for (const NumberColumn& column : block.numbers) {
    entity.looked_at.insert(ReflectionKind::kNotFinite);
    if (column.minimum || column.maximum || column.meaning == NumberColumn::Meaning::kOrientation)
      entity.looked_at.insert(ReflectionKind::kOutOfBounds);
    look_at_numbers(block, column, findings);
    if (column.meaning == NumberColumn::Meaning::kOrientation && column.width == 4)
      look_at_norms(block, column, findings);
  }
}

std::vector<DescribedLimits> find_limits(const SeriesBlock& block) {
  const NumberColumn* lower = column_named(block, "lower");
  const NumberColumn* upper = column_named(block, "upper");
  if (lower == nullptr || upper == nullptr || lower->width != upper->width || lower->width < 2)
    return {};
  const auto last = [](const NumberColumn& column) {
    std::vector<double> values;
    for (size_t k = 0; k < column.width; ++k)
      values.push_back(column.at(column.rows.size() - 1, k));
    return values;
  };
  return {{block.entity, last(*lower), last(*upper)}};
}

void look_at_limits(const SeriesBlock& block, const std::vector<DescribedLimits>& limits,
                    EntityReflection& entity, FindingList& findings) {
  for (const DescribedLimits& described : limits) {
    if (described.description == block.entity ||
        described.description.names().front() != block.entity.names().front())
      continue;
    for (const NumberColumn& column : block.numbers) {
      if (column.width != described.lower.size() || !is_position(column.path)) continue;
      // Limits of joints are soft, and encoders round.
      const auto is_within = [&](size_t i) {
        const double low = described.lower[i / column.rows.size()],
                     high = described.upper[i / column.rows.size()];
        const double slack = kLimitSlack * (high - low);
        const double value = column.values[i];
        return !std::isfinite(value) || (value >= low - slack && value <= high + slack);
      };
      size_t within = 0;
      for (size_t i = 0; i < column.values.size(); ++i) within += is_within(i) ? 1 : 0;
      if (static_cast<double>(within) < kWithinShare * static_cast<double>(column.values.size()))
        continue;
      entity.looked_at.insert(ReflectionKind::kOutOfBounds);
      for (size_t i = 0; i < column.values.size(); ++i) {
        if (is_within(i)) continue;
        const size_t element = i / column.rows.size();
        auto finding = number_finding(block, ReflectionKind::kOutOfBounds, column,
                                      i % column.rows.size(), element);
        finding.expected = fmt::format("{:.6g} to {:.6g}, as {} says", described.lower[element],
                                       described.upper[element], described.description.to_string());
        findings.add(std::move(finding));
      }
    }
  }
}

}  // namespace engram::ltm
