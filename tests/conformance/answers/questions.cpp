// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/answers/questions.h"

#include <fmt/format.h>

namespace engram::testing {

namespace {

/// Selectors that every entity is asked with: about all forms, the forgotten, and the future.
const std::vector<std::string> kSelectors = {
    "all",
    "latest",
    "latest:3",
    "latest:500",
    "0..4",
    "-3..-1",
    "25..35",
    "55..62",
    "last:3s",
    "last:1000d",
    "2020-09-13 12:26:40",
    "2020-09-13 12:26:48.000000",
    "nearest:2020-09-13 12:26:43.100000",
    "nearest:2020-09-13 12:26:43.050000~40ms",
    "before:2020-09-13 12:26:44.000000",
    "after:2020-09-13 12:26:50.000000",
    "2020-09-13 12:26:41.000000..2020-09-13 12:26:45.000000",
    "2020-09-13 12:26:51.000000..2020-09-13 12:26:54.000000",
    "latest#0",
    "latest#1",
    "all#7",
    "+200ms",
    "+150ms",
    "+200ms, +1s, +400ms",
    "+200ms#1",
    "latest:2, +200ms, 0..1",
    "+10s",
    "+1min",
    "+61s",
    "+100000d",
    "2090-01-01 00:00:00",
};

const std::vector<std::string> kNames = {
    "Vision/RGB/head/cam",        "Vision/RGB/head/damaged",    "Vision/RGB/head/led",
    "Robot/State/arm/joints",     "Robot/State/arm/broken",     "Robot/State/arm/forgotten",
    "Objects/Things/kitchen/cup", "Speech/Commands/human/text", "Nothing/like/that/exists",
};

/// Queries of several entities at once.
const std::vector<std::string> kMore = {
    ".* @ latest",
    "Vision/.* @ latest:2",
    "Vision/RGB/head/(cam|led) @ +200ms, latest",
    "Robot ; Objects @ all",
    "Robot/State/arm/joints @ latest:2 ; Speech @ all ; Nothing @ all",
    "Nothing/.* @ all",
    "Vision/RGB/head/cam @ latest ; Vision/RGB/head/cam @ 0..1#0",
};

/// Now, in the store alone, between two snapshots, in working memory alone, the last, later and
/// before all.
std::vector<std::optional<Time>> moments() {
  std::vector<std::optional<Time>> all{{}};
  for (const int64_t ns :
       {1'600'000'004'000'000'000, 1'600'000'004'100'000'000, 1'600'000'015'000'000'000,
        1'600'000'015'800'000'000, 1'700'000'000'000'000'000, -2'000'000'000'000'000'000})
    all.emplace_back(time_from_ns(ns));
  return all;
}

}  // namespace

std::vector<std::string> questions() {
  std::vector<std::string> all = kMore;
  for (const std::string& name : kNames)
    for (const std::string& selector : kSelectors) all.push_back(name + " @ " + selector);
  const size_t with_data = all.size();
  for (size_t i = 0; i < with_data; ++i) all.push_back("?ids " + all[i]);
  return all;
}

std::string FutureQuestion::text() const {
  return fmt::format("{} +{} from {}, by '{}', plan {}", entity,
                     to_string(request.horizons.front()),
                     request.from ? to_string(*request.from) : "now", request.engine,
                     request.plan ? request.plan->to_string() : "none");
}

std::vector<FutureQuestion> future_questions() {
  const auto parsed = [](const std::string& text) { return *ltm::MemoryId::parse(text); };
  std::vector<std::optional<ltm::MemoryId>> plans{{}};
  for (const char* plan : {"Robot/State/arm/joints", "Robot/State/arm/broken",
                           "Speech/Commands/human/text", "Nothing/like/that/exists"})
    plans.emplace_back(parsed(plan));
  const std::vector<Duration> some{std::chrono::seconds(1), std::chrono::milliseconds(200)};
  std::vector<FutureQuestion> all;
  for (const std::string& name : kNames)
    for (const auto& from : moments())
      for (const auto& plan : plans)
        for (const char* engine : {"", "deep", "copy-last", "line", "oracle"})
          all.push_back({name, {from, some, engine, plan}});
  all.push_back({kNames[0], {moments()[1], {std::chrono::minutes(2)}, "", {}}});
  return all;
}

std::string EnginesQuestion::text() const {
  return fmt::format("engines of {}, {} ahead at {}", entity, to_string(ahead),
                     at ? to_string(*at) : "now");
}

std::vector<EnginesQuestion> engines_questions() {
  std::vector<EnginesQuestion> all;
  for (const std::string& name : kNames)
    for (const Duration ahead :
         {Duration(std::chrono::milliseconds(200)), Duration(std::chrono::seconds(1))})
      for (const auto& at : moments()) all.push_back({name, ahead, at});
  return all;
}

std::vector<std::string> latent_questions() {
  std::vector<std::string> all;
  for (const std::string& name : kNames)
    for (const char* selector : {"all", "latest", "0..4", "25..35", "+200ms", "all#1"})
      all.push_back(name + " @ " + selector);
  return all;
}

}  // namespace engram::testing
