// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/members_text.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <vector>

#include "reports/plain/text.h"

namespace engram::reports {

namespace {

/// Such as "position by constant-velocity, RMSE 0.024, 90 %: 0.051, moving".
std::string member_text(const ltm::MemberPrediction& member) {
  const auto error_of = [&](double mse) {
    return error_text(member.is_image ? ltm::MeasuredError{mse}
                                      : ltm::MeasuredError{std::nan(""), mse});
  };
  std::string text =
      fmt::format("{} by {}", member.path.empty() ? "value" : member.path, member.engine);
  if (member.copied > 0 && member.copied < 1)
    text += fmt::format(", {:.0f} % copied", 100 * member.copied);
  if (!std::isnan(member.expected_mse)) text += ", " + error_of(member.expected_mse);
  if (!std::isnan(member.bound_mse))
    text += fmt::format(", {:.0f} %: {}", 100 * ltm::kBoundProbability, error_of(member.bound_mse));
  if (member.is_moving) text += ", moving";
  return text;
}

}  // namespace

std::string members_text(const ltm::SnapshotResult& snapshot) {
  constexpr size_t kMaxNamed = 6;
  std::vector<const ltm::MemberPrediction*> members;
  for (const ltm::InstanceResult& instance : snapshot.instances)
    for (const ltm::MemberPrediction& member : instance.members)
      if (member.copied < 1 || !std::isnan(member.expected_mse)) members.push_back(&member);
  std::string text;
  if (members.size() <= kMaxNamed) {
    for (const ltm::MemberPrediction* member : members)
      text += (text.empty() ? "" : "; ") + member_text(*member);
    return text;
  }
  std::map<std::string, size_t> counts;
  size_t moving = 0;
  for (const ltm::MemberPrediction* member : members) {
    ++counts[member->engine];
    moving += member->is_moving ? 1 : 0;
  }
  for (const auto& [engine, count] : counts)
    text += fmt::format("{}{} by {}", text.empty() ? "" : ", ", count, engine);
  return fmt::format("{} members: {}; {} moving", members.size(), text, moving);
}

}  // namespace engram::reports
