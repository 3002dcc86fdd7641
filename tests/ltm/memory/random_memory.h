// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ltm/memory/commit.h"
#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "tests/ltm/print_values.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {

/// Few names, so that made-up IDs and patterns meet.
inline MemoryId random_entity(RandomValues& random) {
  static const std::vector<std::string> kNames{"a", "b", "ab", "a/b", "x.y", "; @", "é"};
  std::vector<std::string> names;
  for (size_t i = 0; i < MemoryId::kNameLevels; ++i)
    names.push_back(kNames[random.below(kNames.size())]);
  return *MemoryId::from_names(std::move(names));
}

inline NamePattern random_pattern(RandomValues& random) {
  static const std::vector<std::string> kTexts{
      "a",       "b",      "a.*",   "a|b",    "[a-b]{1,2}", "x\\.y",    "x.y",
      "(a/b)",   "\\d+",   "; @.*", "\\ a",   "a\\\\",      "a\\/[/;]", ".+\\@$",
      "[^;@]+ ", "?ids a", "\\?a",  "(?i)AB", "\\\\\\/+",   "é|ü\\;",   "[[:alpha:]]+"};
  switch (random.below(4)) {
    case 0:
      return {};
    case 1:
      return *NamePattern::name("n" + random.text());
    default:
      return NamePattern::parse(kTexts[random.below(kTexts.size())]).value_or({});
  }
}

inline Selector random_selector(RandomValues& random) {
  const Time a = time_from_ns(static_cast<int64_t>(random.bits()));
  const Time b = time_from_ns(static_cast<int64_t>(random.bits()));
  const Duration duration(static_cast<int64_t>(random.bits() >> (1 + random.below(60))));
  const auto count = static_cast<int64_t>(random.bits() >> (1 + random.below(62)));
  switch (random.below(10)) {
    case 0:
      return select::All{};
    case 1:
      return select::Latest{count + 1 > 0 ? count + 1 : 1};
    case 2:
      return select::At{a};
    case 3:
      return select::Ahead{random.below(2) == 0 ? duration : -duration};
    case 4:
      return select::Nearest{a, random.below(4) == 0 ? Duration::max() : duration};
    case 5:
      return select::Before{a, random.below(2) == 0};
    case 6:
      return select::After{a};
    case 7:
      return select::TimeRange{std::min(a, b), std::max(a, b)};
    case 8:
      return select::LastDuration{duration};
    default:
      return select::IndexRange{-count, static_cast<int64_t>(random.bits())};
  }
}

inline SnapshotQuery random_snapshot_query(RandomValues& random) {
  SnapshotQuery query{random_selector(random), {}};
  if (random.below(3) == 0)
    for (size_t count = random.below(4); count > 0; --count)
      query.instances.push_back(static_cast<int32_t>(random.below(1000)));
  return query;
}

/// Any tree, siblings of the same names and selectors included.
template <typename Level = MemoryQuery>
std::vector<Level> random_query_tree(RandomValues& random) {
  std::vector<Level> level;
  for (size_t count = 1 + random.below(3); count > 0; --count) {
    if constexpr (std::is_same_v<Level, SnapshotQuery>) {
      level.push_back(random_snapshot_query(random));
    } else {
      using Below = typename decltype(Level::below)::value_type;
      level.push_back({random_pattern(random), random_query_tree<Below>(random)});
    }
  }
  return level;
}

inline InstanceMetadata random_metadata(RandomValues& random) {
  const auto time = [&random] { return time_from_ns(static_cast<int64_t>(random.bits())); };
  return {time(), time(), time(), random.text(), static_cast<float>(random.below(5)) / 4};
}

inline Snapshot random_snapshot(uint64_t seed) {
  RandomValues random(seed);
  Snapshot snapshot{random_entity(random), time_from_ns(static_cast<int64_t>(random.bits())), {}};
  for (size_t count = 1 + random.below(4); count > 0; --count)
    snapshot.instances.push_back({random.value(3), random_metadata(random)});
  return snapshot;
}

inline SnapshotResult random_snapshot_result(RandomValues& random, Time time, bool is_ids_only) {
  SnapshotResult snapshot;
  snapshot.time = time;
  snapshot.source = static_cast<Source>(random.below(4));
  if (random.below(2) == 0) snapshot.model = "m" + random.text();
  if (random.below(2) == 0) snapshot.predictor = "copy-last";
  if (random.below(2) == 0) snapshot.horizon = Duration(static_cast<int64_t>(random.bits()));
  for (int32_t index = 0; index < 3; ++index) {
    if (random.below(3) == 0) continue;
    InstanceResult instance;
    instance.index = index;
    if (!is_ids_only) {
      instance.data = random.value(2);
      instance.metadata = random_metadata(random);
      if (random.below(2) == 0) instance.error = MeasuredError{.image_mse = 2.5};
      if (random.below(2) == 0) instance.bound = MeasuredError{.number_mse = 0.5};
    }
    snapshot.instances.push_back(std::move(instance));
  }
  return snapshot;
}

/// Added in no order, so that the tree has to find its own.
inline QueryResult random_result(RandomValues& random, bool is_ids_only) {
  QueryResult result(is_ids_only);
  for (size_t entities = random.below(8); entities > 0; --entities) {
    EntityResult& entity = result.add_entity(random_entity(random));
    for (size_t count = random.below(5); count > 0; --count)
      entity.add(random_snapshot_result(random, time_from_ns(static_cast<int64_t>(random.below(6))),
                                        is_ids_only));
  }
  return result;
}

}  // namespace engram::ltm
