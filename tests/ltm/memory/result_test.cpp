// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/result.h"

#include <algorithm>
#include <cmath>

#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/memory/random_memory.h"

namespace engram::ltm {
namespace {

Time t(int64_t ns) {
  return time_from_ns(ns);
}

SnapshotResult snapshot(int64_t ns, Source source, std::vector<int32_t> indices) {
  SnapshotResult made;
  made.time = t(ns);
  made.source = source;
  for (const int32_t index : indices) made.instances.push_back({index, idf::Data(index), {}});
  return made;
}

TEST(QueryResult, IsATreeOfSixLevelsInOrder) {
  QueryResult result;
  result.add_entity(*MemoryId::parse("b/x/p/e2")).add(snapshot(7, Source::kRecorded, {0}));
  result.add_entity(*MemoryId::parse("a/y/p/e1"));
  result.add_entity(*MemoryId::parse("b/x/p/e1")).add(snapshot(5, Source::kRecorded, {1, 3}));
  result.add_entity(*MemoryId::parse("b/x/p/e1")).add(snapshot(4, Source::kRecorded, {0}));
  ASSERT_EQ(result.memories().size(), 2u);
  EXPECT_EQ(result.memories()[0].name, "a");
  EXPECT_EQ(result.memories()[1].below[0].below[0].name, "p");
  const EntityResult& entity = result.memories()[1].below[0].below[0].below[0];
  EXPECT_EQ(entity.id.to_string(), "b/x/p/e1");
  EXPECT_EQ(entity.snapshots[0].time, t(4));
  EXPECT_EQ(entity.snapshots[1].instances[1].index, 3);
  std::vector<std::string> ids;
  for (const MemoryId& id : result.ids()) ids.push_back(id.to_string());
  EXPECT_EQ(ids, (std::vector<std::string>{"a/y/p/e1", "b/x/p/e1/1970-01-01 00:00:00.000000004/0",
                                           "b/x/p/e1/1970-01-01 00:00:00.000000005/1",
                                           "b/x/p/e1/1970-01-01 00:00:00.000000005/3",
                                           "b/x/p/e2/1970-01-01 00:00:00.000000007/0"}));
  EXPECT_EQ(result.snapshot_count(), 3u);
  EXPECT_EQ(result.size_bytes(), 4 * idf::encoded_size(idf::Data(1)));
}

TEST(QueryResult, FindsWhatItHasAndNothingElse) {
  RandomValues random(51);
  for (int i = 0; i < 500; ++i) {
    const QueryResult result = random_result(random, false);
    for (const EntityResult* entity : result.entities()) {
      EXPECT_EQ(result.find_entity(entity->id), entity);
      for (const SnapshotResult& one : entity->snapshots) {
        const MemoryId id = entity->id.at(one.time);
        EXPECT_EQ(result.find_snapshot(id), &one);
        EXPECT_EQ(result.find_entity(id), entity);
        for (const InstanceResult& instance : one.instances)
          EXPECT_EQ(result.find_instance(id.instance(instance.index)), &instance);
      }
    }
    const std::vector<MemoryId> ids = result.ids();
    EXPECT_TRUE(std::ranges::is_sorted(ids));
    for (MemoryId id : ids)
      for (; id.depth() > 0; id = id.parent()) EXPECT_TRUE(result.contains(id));
    for (int k = 0; k < 10; ++k) {
      const MemoryId entity = random_entity(random);
      const MemoryId instance = entity.at(t(2)).instance(1);
      for (MemoryId id = instance; id.depth() > 0; id = id.parent()) {
        const bool is_there = std::ranges::any_of(
            ids, [&id](const MemoryId& known) { return id.is_prefix_of(known); });
        EXPECT_EQ(result.contains(id), is_there) << id.to_string();
      }
    }
  }
  EXPECT_TRUE(QueryResult().contains(MemoryId()));
  EXPECT_EQ(QueryResult().find_snapshot(MemoryId()), nullptr);
}

TEST(QueryResult, MergesWithTheTruthFirst) {
  const MemoryId id = *MemoryId::parse("a/b/c/d"), other = *MemoryId::parse("a/b/c/e");
  QueryResult ours, theirs;
  EntityResult& entity = ours.add_entity(id);
  entity.add(snapshot(1, Source::kPredicted, {0, 1}));
  entity.add(snapshot(2, Source::kRecorded, {0}));
  entity.add(snapshot(3, Source::kRecorded, {0, 2}));
  EntityResult& second = theirs.add_entity(id);
  second.add(snapshot(0, Source::kReconstructed, {0}));
  second.add(snapshot(1, Source::kRecorded, {0}));
  second.add(snapshot(2, Source::kPredicted, {0, 1}));
  second.add(snapshot(3, Source::kRecorded, {1, 2}));
  theirs.add_entity(other);
  ASSERT_OK(ours.merge(theirs));
  const auto& merged = ours.find_entity(id)->snapshots;
  EXPECT_EQ(merged,
            (std::vector<SnapshotResult>{
                snapshot(0, Source::kReconstructed, {0}), snapshot(1, Source::kRecorded, {0}),
                snapshot(2, Source::kRecorded, {0}), snapshot(3, Source::kRecorded, {0, 1, 2})}));
  EXPECT_NE(ours.find_entity(other), nullptr);
  EXPECT_FAILS(ours.merge(QueryResult(true)), StatusCode::kInvalidArgument, "only IDs");
}

TEST(QueryResult, MergingIsIdempotentAndKeepsEverything) {
  RandomValues random(52);
  for (int i = 0; i < 500; ++i) {
    const QueryResult a = random_result(random, true), b = random_result(random, true);
    QueryResult merged = a;
    ASSERT_OK(merged.merge(b));
    for (const QueryResult* part : {&a, &b})
      for (const EntityResult* entity : part->entities())
        for (const SnapshotResult& one : entity->snapshots)
          EXPECT_NE(merged.find_snapshot(entity->id.at(one.time)), nullptr);
    const QueryResult once = merged;
    ASSERT_OK(merged.merge(b));
    ASSERT_OK(merged.merge(a));
    EXPECT_EQ(merged, once);
  }
}

TEST(QueryResult, ReadsBackItsDataInBothForms) {
  RandomValues random(53);
  for (int i = 0; i < 300; ++i) {
    const QueryResult result = random_result(random, i % 2 == 0);
    const auto bytes = idf::encode(result.to_data(), idf::kMaxDepth + idf::kContainerDepth);
    ASSERT_OK(bytes);
    const auto data = idf::decode(Buffer::copy(*bytes), idf::kMaxDepth + idf::kContainerDepth);
    ASSERT_OK(data);
    EXPECT_EQ(*QueryResult::from_data(*data), result);
    const auto json = idf::to_json_text(result.to_data());
    ASSERT_OK(json);
    EXPECT_EQ(*QueryResult::from_data(*idf::from_json_text(*json)), result);
  }
}

TEST(QueryResult, ReadsBackHowMembersWerePredicted) {
  QueryResult result;
  SnapshotResult predicted = snapshot(7, Source::kPredicted, {0});
  predicted.plan = "Robot/State/arm/planned";
  MemberPrediction position{"pose/position", "quadratic", 0.25, 1.5, 0, false, true};
  MemberPrediction image{"image", "deep", std::nan(""), std::nan(""), 0.5, true, false};
  MemberPrediction mode{"mode", "copy-last", std::nan(""), std::nan(""), 1, false, false, false};
  predicted.instances[0].members = {position, image, mode};
  result.add_entity(*MemoryId::parse("a/b/c/d")).add(predicted);
  const auto read = QueryResult::from_data(result.to_data());
  ASSERT_OK(read);
  EXPECT_EQ(*read, result);
  EXPECT_EQ(read->entities()[0]->snapshots[0].plan, predicted.plan);
  EXPECT_EQ(read->entities()[0]->snapshots[0].instances[0].members[1].copied, 0.5);
  // Answers of earlier versions do not say which members count: all do.
  idf::Data earlier = result.to_data();
  const auto child = [](idf::Data& data, const char* name, size_t index) -> idf::Data& {
    return data.get_if<idf::Dict>()->find(name)->get_if<idf::List>()->at(index);
  };
  idf::Data& member = child(
      child(child(child(earlier, "entities", 0), "snapshots", 0), "instances", 0), "members", 2);
  idf::Dict without;
  for (const auto& [name, value] : *member.get_if<idf::Dict>())
    if (name != "is_counted") without.set(name, value);
  member = without;
  const auto read_earlier = QueryResult::from_data(earlier);
  ASSERT_OK(read_earlier);
  EXPECT_TRUE(read_earlier->entities()[0]->snapshots[0].instances[0].members[2].is_counted);
}

TEST(QueryResult, CarriesTheDeepestValueThatThereIs) {
  QueryResult result;
  result.add_entity(*MemoryId::parse("a/b/c/d")).add(snapshot(5, Source::kRecorded, {0}));
  EntityResult& entity = result.add_entity(*MemoryId::parse("a/b/c/d"));
  entity.snapshots[0].instances[0].data = nested_lists(idf::kMaxDepth);
  constexpr int kDepth = idf::kMaxDepth + idf::kContainerDepth;
  EXPECT_OK(idf::encode(result.to_data(), kDepth));
  const auto json = idf::to_json_text(result.to_data(), -1, kDepth);
  ASSERT_OK(json);
  EXPECT_EQ(*QueryResult::from_data(*idf::from_json_text(*json, kDepth)), result);
}

TEST(QueryResult, RefusesDataThatIsNone) {
  QueryResult made;
  EntityResult& entity = made.add_entity(*MemoryId::parse("a/b/c/d"));
  entity.add(snapshot(5, Source::kRecorded, {0, 1}));
  entity.add(snapshot(6, Source::kRecorded, {0}));
  made.add_entity(*MemoryId::parse("a/b/c/e"));
  const idf::Data good = made.to_data();
  const auto changed = [&good](std::string_view path, idf::Data value) {
    idf::Data data = good;
    *data.at(path) = std::move(value);
    return QueryResult::from_data(data);
  };
  const std::tuple<const char*, idf::Data, const char*> cases[] = {
      {"", 5, "result: found int32"},
      {"ids_only", "no", "needs a bool"},
      {"entities", 5, "needs a list"},
      {"entities/1/id", "a/b/c/d", "increasing names"},
      {"entities/1/id", "a", "'a' is no entity"},
      {"entities/0/snapshots/1/time", int64_t{5}, "increasing times"},
      {"entities/0/snapshots/0/source", "dreamt", "'dreamt' is not known"},
      {"entities/0/snapshots/0/instances/1/index", 0, "increasing indices"},
      {"entities/0/snapshots/0/instances/0/index", -1, "no instance index"},
      {"entities/0/snapshots/0/instances/0/index", int64_t{1} << 31, "no instance index"},
      {"entities/0/snapshots/0/instances/0/metadata", idf::None{}, "metadata: found none"}};
  for (const auto& [path, value, part] : cases)
    EXPECT_FAILS(changed(path, value), StatusCode::kInvalidArgument, part);
}

}  // namespace
}  // namespace engram::ltm
