// SPDX-License-Identifier: Apache-2.0
#include "cli/shared_progress.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/command.h"

namespace engram::cli {

namespace {

double share_of(const Progress& one) {
  return one.total > 0 ? static_cast<double>(one.done) / static_cast<double>(one.total) : 0;
}

}  // namespace

void SharedProgress::tell(size_t child, const std::string& line, bool passes_on) {
  const Json json = Json::parse(line, nullptr, false);
  const bool is_progress = json.is_object() && json.contains("what");
  if (!is_progress || passes_on) {
    line_.finish();
    fmt::print(stderr, "{}\n", line);
    return;
  }
  if (!sink_) return;
  Progress& now = last_[child];
  now.what = json.value("what", "");
  now.done = json.value("done", uint64_t{0});
  const Json total = json.value("total", Json());
  now.total = total.is_number_unsigned() ? total.get<uint64_t>() : 0;
  const Json left = json.value("seconds_left", Json());
  now.seconds_left = left.is_number() ? left.get<double>() : -1;
  sink_(united());
}

Progress SharedProgress::united() const {
  constexpr uint64_t kParts = 1000;
  Progress all{fmt::format("{} processes", last_.size()), 0, kParts, "", -1};
  double share = 0;
  for (const Progress& one : last_) {
    share += share_of(one) / static_cast<double>(last_.size());
    if (one.what.empty()) continue;
    all.detail +=
        fmt::format("{}{} {:.0f} %", all.detail.empty() ? "" : ", ", one.what, 100 * share_of(one));
    all.seconds_left = std::max(all.seconds_left, one.seconds_left);
  }
  all.done = static_cast<uint64_t>(share * (kParts - 1));
  return all;
}

}  // namespace engram::cli
