// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/fact_members.h"

#include <algorithm>
#include <cmath>

#include "ltm/idf/type.h"

namespace engram::speech {

namespace {

template <typename Number>
std::vector<double> as_doubles(const idf::NdArray& array) {
  std::vector<double> numbers;
  for (const Number number : array.values<Number>()) numbers.push_back(number);
  return numbers;
}

std::optional<std::vector<double>> finite_array(const idf::Data* data, size_t count) {
  const auto* array = data == nullptr ? nullptr : data->get_if<idf::NdArray>();
  if (array == nullptr || array->count() != static_cast<int64_t>(count)) return {};
  std::vector<double> numbers;
  if (array->type() == idf::ElementType::kFloat64) numbers = as_doubles<double>(*array);
  if (array->type() == idf::ElementType::kFloat32) numbers = as_doubles<float>(*array);
  if (numbers.size() != count) return {};
  for (const double number : numbers)
    if (!std::isfinite(number)) return {};
  return numbers;
}

/// The heading of the x axis that a quaternion w, x, y, z turns.
double heading_of(const std::vector<double>& q) {
  return std::atan2(2 * (q[1] * q[2] + q[0] * q[3]), 1 - 2 * (q[2] * q[2] + q[3] * q[3]));
}

std::optional<Spot> spot_of(const idf::Data& member) {
  if (const auto planar = finite_array(&member, 3))
    return Spot{(*planar)[0], (*planar)[1], 0, (*planar)[2]};
  const auto position = finite_array(member.at(idf::kPositionKey), 3);
  if (!position) return {};
  const auto turned = finite_array(member.at(idf::kOrientationKey), 4);
  return Spot{(*position)[0], (*position)[1], (*position)[2], turned ? heading_of(*turned) : 0};
}

}  // namespace

std::string text_in(const idf::Data& value, std::string_view member) {
  const auto* dict = value.get_if<idf::Dict>();
  const idf::Data* found = dict == nullptr ? nullptr : dict->find(member);
  const auto* text = found == nullptr ? nullptr : found->get_if<std::string>();
  return text == nullptr ? std::string() : *text;
}

std::optional<int64_t> integer_in(const idf::Data& value, std::string_view member) {
  const auto* dict = value.get_if<idf::Dict>();
  const idf::Data* found = dict == nullptr ? nullptr : dict->find(member);
  if (found == nullptr) return {};
  if (const auto* flag = found->get_if<bool>()) return *flag ? 1 : 0;
  if (const auto* narrow = found->get_if<int32_t>()) return *narrow;
  if (const auto* wide = found->get_if<int64_t>()) return *wide;
  return {};
}

std::optional<Time> time_in(const idf::Data& value, std::string_view member) {
  const auto* dict = value.get_if<idf::Dict>();
  const idf::Data* found = dict == nullptr ? nullptr : dict->find(member);
  const auto* ns = found == nullptr ? nullptr : found->get_if<int64_t>();
  // The difference of two times has to fit into a Duration, too.
  constexpr int64_t kMaxTime_ns = 4'000'000'000'000'000'000;
  if (ns == nullptr || *ns > kMaxTime_ns || *ns < -kMaxTime_ns) return {};
  return time_from_ns(*ns);
}

std::optional<ltm::MemoryId> link_named(const std::string& text) {
  // Three slashes at least: most texts are no links and need not be parsed.
  if (std::count(text.begin(), text.end(), '/') < 3) return {};
  auto id = ltm::MemoryId::parse(text);
  if (!id.ok() || !id->has_entity()) return {};
  return *std::move(id);
}

std::optional<ltm::MemoryId> link_in(const idf::Data& value, std::string_view member) {
  return link_named(text_in(value, member));
}

std::vector<ltm::MemoryId> links_in(const idf::Data& value, std::string_view member) {
  std::vector<ltm::MemoryId> links;
  if (auto single = link_in(value, member)) links.push_back(*std::move(single));
  const auto* dict = value.get_if<idf::Dict>();
  const idf::Data* found = dict == nullptr ? nullptr : dict->find(member);
  const auto* list = found == nullptr ? nullptr : found->get_if<idf::List>();
  if (list == nullptr) return links;
  for (const idf::Data& one : *list)
    if (const auto* text = one.get_if<std::string>())
      if (auto link = link_named(*text)) links.push_back(*std::move(link));
  return links;
}

std::optional<std::vector<double>> numbers_in(const idf::Data& value, std::string_view member,
                                              size_t count) {
  const auto* dict = value.get_if<idf::Dict>();
  return dict == nullptr ? std::nullopt : finite_array(dict->find(member), count);
}

ltm::ActionOutcome outcome_member(const idf::Data& value) {
  if (const std::string text = text_in(value, "outcome"); !text.empty())
    return ltm::outcome_named(text);
  using ltm::ActionOutcome;
  constexpr std::array kOutcomes{ActionOutcome::kRunning, ActionOutcome::kSuccess,
                                 ActionOutcome::kFailure, ActionOutcome::kStop};
  const auto number = integer_in(value, "outcome");
  if (!number || *number < 0 || *number >= static_cast<int64_t>(kOutcomes.size()))
    return ActionOutcome::kUnknown;
  return kOutcomes.at(static_cast<size_t>(*number));
}

std::optional<Spot> spot_in(const idf::Data& value, std::string_view prefix) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return {};
  for (const idf::DictEntry& member : *dict)
    if (member.key.starts_with(prefix))
      if (auto spot = spot_of(member.value)) return spot;
  return {};
}

}  // namespace engram::speech
