// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/working_memory.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/working/plain_memory.h"

namespace engram::ltm {
namespace {

using engram::testing::PlainMemory;

TEST(WorkingMemory, AnswersWithWhatWasCommitted) {
  PlainMemory memory({});
  memory.commit("Vision/RGB/head/cam", 10, "first");
  memory.commit("Vision/RGB/head/cam", 20, "second");
  const auto answer = memory->query(*Query::parse("Vision"));
  ASSERT_EQ(answer.snapshot_count(), 1u);
  const auto& instance = answer.entities()[0]->snapshots[0].instances[0];
  EXPECT_EQ(instance.data, idf::Data("second"));
  EXPECT_EQ(instance.metadata.arrived, memory.now);
  EXPECT_EQ(memory->counters().reads, 1u);
}

TEST(WorkingMemory, SharesWhatItGivesOut) {
  PlainMemory memory({});
  memory.commit("A/b/c/d", 10);
  const auto id = *MemoryId::parse("A/b/c/d");
  EXPECT_EQ(memory->find(id), memory->find(id.at(time_from_ns(10))));
  EXPECT_EQ(memory->select(*Query::parse("A"))[0].snapshots[0], memory->find(id));
  EXPECT_EQ(memory->find(id.at(time_from_ns(11))), nullptr);
  EXPECT_EQ(memory->find(*MemoryId::parse("A/b/c/e")), nullptr);
  EXPECT_EQ(memory->find(*MemoryId::parse("A/b")), nullptr);
}

TEST(WorkingMemory, TakesTheSameTimeForACorrection) {
  PlainMemory memory({});
  memory.commit("A/b/c/d", 10, "wrong");
  memory.commit("A/b/c/d", 10, "right");
  EXPECT_EQ(memory->find(*MemoryId::parse("A/b/c/d"))->instances[0].data, idf::Data("right"));
  const auto counts = memory->counters();
  EXPECT_EQ(counts.snapshots, 1u);
  EXPECT_EQ(counts.superseded, 1u);
  EXPECT_EQ(counts.committed, 2u);
}

TEST(WorkingMemory, SelectsAsEveryMemoryDoes) {
  PlainMemory memory({});
  for (const int64_t at : {100, 400, 200, 300}) memory.commit("A/b/c/d", at);
  memory.commit("A/b/c/e", 250);
  const auto at = [](const std::string& time) {
    return "A/b/c/d/1970-01-01 00:00:00.000000" + time + "/0";
  };
  const std::vector<std::string> all{at("100"), at("200"), at("300"), at("400")};
  EXPECT_EQ(memory.ask("A/b/c/d @ all"), all);
  EXPECT_EQ(memory.ask("A/b/c/d @ time:200..300"), memory.ask("A/b/c/d @ -3..-2"));
  EXPECT_EQ(memory.ask("A/b/c/d @ before:200"), std::vector{at("100")});
  EXPECT_EQ(memory.ask("A/b/c/d @ at-or-before:200"), std::vector{at("200")});
  EXPECT_EQ(memory.ask("A/b/c/d @ after:300"), std::vector{at("400")});
  EXPECT_EQ(memory.ask("A/b/c/d @ nearest:240"), std::vector{at("200")});
  EXPECT_EQ(memory.ask("A/b/c/d @ before:100"), std::vector<std::string>{"A/b/c/d"});
  EXPECT_EQ(memory.ask("A/b/c/.* @ latest").size(), 2u);
  EXPECT_TRUE(memory.ask("A/b/c/x").empty());
}

TEST(WorkingMemory, NamesMomentsThatAreToBePredicted) {
  PlainMemory memory({});
  memory.commit("A/b/c/d", 100);
  const auto selected = memory->select(*Query::parse("A/b/c/d @ +200ns, latest"));
  ASSERT_EQ(selected.size(), 1u);
  EXPECT_EQ(selected[0].future, std::vector{time_from_ns(300)});
  EXPECT_EQ(selected[0].snapshots.size(), 1u);
}

TEST(WorkingMemory, GivesTheInstancesThatAreAskedFor) {
  PlainMemory memory({});
  Snapshot two = PlainMemory::snapshot("A/b/c/d", 10, "zero");
  two.instances.push_back({"one", {}});
  ASSERT_TRUE(memory->commit({{two}}).ok());
  EXPECT_EQ(memory.ask("A @ latest#1").size(), 1u);
  EXPECT_EQ(memory.ask("A @ latest").size(), 2u);
  EXPECT_EQ(memory.ask("A @ latest#7"), std::vector<std::string>{"A/b/c/d"});
  const auto ids = memory->query(*Query::parse("?ids A"));
  EXPECT_TRUE(ids.entities()[0]->snapshots[0].instances[0].data.is<idf::None>());
}

TEST(WorkingMemory, CastsToTheTypeOfTheSegment) {
  PlainMemory memory({});
  const auto type = idf::Type::object("Cup", {{"fill", idf::Type::float64()}});
  ASSERT_TRUE(memory->declare(*MemoryId::parse("A/b"), type).ok());
  memory.commit("A/b/c/d", 10, idf::Dict{{"fill", int64_t{1}}, {"colour", "blue"}});
  EXPECT_EQ(memory->find(*MemoryId::parse("A/b/c/d"))->instances[0].data,
            idf::Data(idf::Dict{{"fill", 1.0}}));
  EXPECT_EQ(memory->counters().reinterpreted, 1u);
}

TEST(WorkingMemory, HasNothingBeforeAChangeOfWhatWasCast) {
  PlainMemory memory({});
  const auto type = idf::Type::object("Cup", {{"fill", idf::Type::float64()}});
  const idf::Data given = idf::Dict{{"fill", int64_t{1}}};
  const auto change = [&](Commit& commit, std::vector<std::vector<Buffer>>& encoded) {
    // No lock is held: both would wait for it.
    EXPECT_EQ(memory->counters().snapshots, 0u);
    EXPECT_TRUE(memory->declare(*MemoryId::parse("A/b"), type).ok());
    ASSERT_EQ(commit.updates.size(), 3u);
    EXPECT_EQ(commit.updates[0].instances[0].data, given) << "the type came after the commit";
    EXPECT_EQ(commit.updates[2].instances[0].data, idf::Data(idf::Dict{{"fill", 1.0}}));
    EXPECT_EQ(encoded[1].size(), 1u);
    EXPECT_TRUE(encoded[2].empty()) << "they hold the value before its cast";
    commit.updates.erase(commit.updates.begin() + 1);
    encoded.erase(encoded.begin() + 1);
    commit.updates[1].instances[0].data = idf::Dict{{"fill", 2.0}};
  };
  ASSERT_TRUE(memory->declare(*MemoryId::parse("X/b"), type).ok());
  const Buffer bytes = Buffer::take(std::vector<std::byte>(4));
  const auto admission = memory->admit(
      {{PlainMemory::snapshot("A/b/c/d", 10, given), PlainMemory::snapshot("A/b/c/e", 10, "goes"),
        PlainMemory::snapshot("X/b/c/d", 10, given)}},
      {{bytes}, {bytes}, {bytes}}, false, change);
  ASSERT_TRUE(admission.ok()) << admission.status().to_string();
  ASSERT_EQ(admission->snapshots.size(), 2u);
  EXPECT_EQ(admission->snapshots[0]->encoded.size(), 1u);
  EXPECT_EQ(memory->find(*MemoryId::parse("X/b/c/d"))->instances[0].data,
            idf::Data(idf::Dict{{"fill", 2.0}}));
  EXPECT_EQ(memory->find(*MemoryId::parse("A/b/c/e")), nullptr);
  const auto nothing = memory->admit(
      {{PlainMemory::snapshot("X/b/c/d", 20, given)}}, {}, false,
      [](Commit& commit, std::vector<std::vector<Buffer>>&) { commit.updates.clear(); });
  ASSERT_TRUE(nothing.ok());
  EXPECT_TRUE(nothing->snapshots.empty());
  EXPECT_EQ(memory->counters().committed, 2u);
}

TEST(WorkingMemory, TakesACommitWholeOrNotAtAll) {
  PlainMemory memory({});
  const auto type = idf::Type::object("Cup", {{"fill", idf::Type::float64()}});
  ASSERT_TRUE(memory->declare(*MemoryId::parse("A/b"), type).ok());
  const Status status = memory->commit({{PlainMemory::snapshot("X/b/c/d", 10, "fine"),
                                         PlainMemory::snapshot("A/b/c/d", 10, "no cup")}});
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(memory->counters().snapshots, 0u);
  EXPECT_EQ(memory->counters().refused, 1u);
  EXPECT_FALSE(memory->commit({{PlainMemory::snapshot("A/b", 10, "no entity")}}).ok());
}

TEST(WorkingMemory, RefusesOptionsThatMakeNoSense) {
  WorkingMemory::Options options;
  options.all.snapshots = 0;
  EXPECT_FALSE(WorkingMemory::create(options).ok());
  options.all.snapshots = 1;
  options.segments = {{*MemoryId::parse("A/b/c/d/10"), {}}};
  EXPECT_FALSE(WorkingMemory::create(options).ok());
  options.segments = {};
  options.read_half_life = Duration(0);
  EXPECT_FALSE(WorkingMemory::create(options).ok());
}

}  // namespace
}  // namespace engram::ltm
