// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/recorder.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "ltm/store/store_reader.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

/// A camera's snapshot `index` of 30 per second.
Snapshot frame(int64_t index, const std::string& name = "cam") {
  Snapshot snapshot = example_snapshot(example_entity(name), index);
  snapshot.time = time_from_ns(kExampleStart_ns + index * 1'000'000'000 / 30);
  return snapshot;
}

class RecorderTest : public ::testing::Test {
 protected:
  EntitySummary summary(const std::string& name = "cam") {
    const auto reader = *StoreReader::open(store());
    const auto found = reader->summary(example_entity(name));
    EXPECT_OK(found);
    return found.value_or({});
  }
  [[nodiscard]] std::filesystem::path store() const { return scratch_ / "store"; }

  ScratchDirectory scratch_;
};

TEST_F(RecorderTest, CountsWhatItKeepsAndDrops) {
  auto recorder = *Recorder::open(store(), {.max_rate_hz = 5.0});
  uint64_t offered_bytes = 0, kept_bytes = 0;
  for (int64_t i = 0; i < 100; ++i) {
    offered_bytes += frame(i).raw_bytes();
    kept_bytes += i % 6 == 0 ? frame(i).raw_bytes() : 0;
    ASSERT_OK(recorder.commit({{frame(i), frame(i, "other")}}));
  }
  ASSERT_EQ(recorder.counters().size(), 2u);
  const RecordingCounters& counters = recorder.counters().at(example_entity());
  EXPECT_EQ(counters.offered, 100u);
  EXPECT_EQ(counters.offered_bytes, offered_bytes);
  EXPECT_EQ(counters.kept, 17u);
  EXPECT_EQ(counters.kept_bytes, kept_bytes);
  EXPECT_GT(counters.stored_bytes, 0u);
  EXPECT_EQ(counters.dropped_by.at("frequency"), 83u);
  // Before the store is closed it knows what was dropped before the last snapshot that was kept.
  EXPECT_EQ(summary().offered, 97u);
  EXPECT_EQ(summary().stored_bytes, counters.stored_bytes);
  ASSERT_OK(recorder.close());
  for (const char* name : {"cam", "other"}) {
    EXPECT_EQ(summary(name).snapshots, 17u);
    EXPECT_EQ(summary(name).offered, 100u);
    EXPECT_EQ(summary(name).dropped_by, (DropReasons{{"frequency", 83}}));
  }
  EXPECT_EQ(summary().offered_bytes, offered_bytes);
  EXPECT_EQ(summary().raw_bytes, kept_bytes);
}

TEST_F(RecorderTest, KeepsEverythingWithoutARate) {
  auto recorder = *Recorder::open(store(), {});
  for (int64_t i = 0; i < 20; ++i) ASSERT_OK(recorder.commit({{frame(i)}}));
  ASSERT_OK(recorder.close());
  const auto reader = *StoreReader::open(store());
  const auto found = read_all(*reader, example_entity());
  ASSERT_EQ(found->size(), 20u);
  for (int64_t i = 0; i < 20; ++i) EXPECT_EQ((*found)[static_cast<size_t>(i)], frame(i));
}

TEST_F(RecorderTest, SealsAsItsRulesSay) {
  EntityRule rule{.name = "cameras", .match = {}, .filters = {}, .pack = {}};
  rule.pack.rules = {{.kind = MediumKind::kImage, .codec = "ffv1:group=4"},
                     {.kind = MediumKind::kNumber, .codec = "columns"}};
  auto recorder = *Recorder::open(store(), {.rules = {rule}});
  const auto taken = [](int64_t i) {
    const idf::Dict value{{"image", example_image(24, 32, 3, i)}, {"x", static_cast<double>(i)}};
    return Snapshot{example_entity(), example_time(i), {{value, {}}}};
  };
  for (int64_t i = 0; i < 10; ++i) ASSERT_OK(recorder.commit({{taken(i)}}));
  {
    const auto unsealed = *StoreReader::open(store());
    EXPECT_TRUE(unsealed->newest_forms(example_entity())->media_codecs.empty());
    EXPECT_EQ((*read_all(*unsealed, example_entity()))[7], taken(7));
  }
  ASSERT_OK(recorder.close());
  const auto reader = *StoreReader::open(store());
  const auto forms = reader->newest_forms(example_entity());
  EXPECT_EQ(forms->media_codecs, std::set<std::string>{"ffv1"});
  EXPECT_TRUE(forms->has_columns());
  const auto found = read_all(*reader, example_entity());
  ASSERT_EQ(found->size(), 10u);
  for (int64_t i = 0; i < 10; ++i) EXPECT_EQ((*found)[static_cast<size_t>(i)], taken(i));
}

TEST_F(RecorderTest, CountsOnceWhatOneCommitDrops) {
  auto recorder = *Recorder::open(store(), {.max_rate_hz = 5.0});
  Commit commit;
  for (int64_t i = 0; i < 20; ++i) commit.updates.push_back(frame(i));
  ASSERT_OK(recorder.commit(commit));
  ASSERT_OK(recorder.close());
  EXPECT_EQ(summary().snapshots, 4u);
  EXPECT_EQ(summary().offered, 20u);
}

TEST_F(RecorderTest, TellsOfDropsThatAFailedCommitWouldHaveTold) {
  auto recorder = *Recorder::open(store(), {.max_rate_hz = 5.0});
  for (int64_t i = 0; i < 5; ++i) ASSERT_OK(recorder.commit({{frame(i)}}));
  Snapshot wrong = frame(6, "bad");
  wrong.instances.front().data = nested_lists(100);
  EXPECT_FAILS(recorder.commit({{frame(6), wrong}}), StatusCode::kInvalidArgument, "nests deeper");
  EXPECT_EQ(recorder.last_time(example_entity()), frame(0).time);
  ASSERT_OK(recorder.commit({{frame(12)}}));
  ASSERT_OK(recorder.close());
  EXPECT_EQ(summary().snapshots, 2u);
  EXPECT_EQ(summary().offered, 6u);
}

TEST_F(RecorderTest, TakesNothingOfACommitThatIsIncomplete) {
  auto recorder = *Recorder::open(store(), {});
  Snapshot empty = frame(1, "empty");
  empty.instances.clear();
  EXPECT_FAILS(recorder.commit({{frame(0), empty}}), StatusCode::kInvalidArgument, "no instance");
  EXPECT_FAILS(recorder.commit({{frame(0), frame(0)}}), StatusCode::kInvalidArgument, "twice");
  EXPECT_TRUE(recorder.counters().empty());
  EXPECT_FALSE(recorder.last_time(example_entity()).has_value());
}

TEST_F(RecorderTest, ContinuesAStore) {
  {
    auto recorder = *Recorder::open(store(), {});
    ASSERT_OK(recorder.commit({{frame(0)}}));
  }
  auto recorder = *Recorder::open(store(), {});
  EXPECT_EQ(recorder.last_time(example_entity()), frame(0).time);
  EXPECT_EQ(recorder.lost_frames(), 0u);
  ASSERT_OK(recorder.commit({{frame(1)}}));
  EXPECT_EQ(recorder.counters().at(example_entity()).kept, 1u);
  EXPECT_FAILS(Recorder::open(store(), {}), StatusCode::kFailedPrecondition, "another process");
}

TEST_F(RecorderTest, RefusesOptionsAndCommitsThatAreWrong) {
  EXPECT_FAILS(Recorder::open(store(), {.max_rate_hz = 0.0}), StatusCode::kInvalidArgument, "0 Hz");
  EXPECT_FAILS(Recorder::open(store(), {.pack = {.image_codec = "gif"}}),
               StatusCode::kInvalidArgument, "'gif'");
  EXPECT_FALSE(std::filesystem::exists(store()));
  auto recorder = *Recorder::open(store(), {});
  Snapshot snapshot = frame(0);
  snapshot.entity = *MemoryId::parse("a/b");
  EXPECT_FAILS(recorder.commit({{snapshot}}), StatusCode::kInvalidArgument, "no entity");
  ASSERT_OK(recorder.commit({}));
}

TEST_F(RecorderTest, KeepsDropCountsBeforeTheLastKeptWhereItIsKilled) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto recorder = Recorder::open(store(), {.max_rate_hz = 5.0});
    for (int64_t i = 0; recorder.ok() && i < 100; ++i)
      if (!recorder->commit({{frame(i)}}).ok()) ::_exit(1);
    ::raise(SIGKILL);
  }
  int outcome = 0;
  ::waitpid(child, &outcome, 0);
  ASSERT_TRUE(WIFSIGNALED(outcome));
  EXPECT_EQ(summary().snapshots, 17u);
  EXPECT_EQ(summary().offered, 97u);
  auto recorder = *Recorder::open(store(), {});
  ASSERT_OK(recorder.close());
  EXPECT_EQ(summary().offered, 97u);
}

idf::Type reading_type() {
  return idf::Type::object("Reading", {{"value", idf::Type::float32({"m", 0, 10})}});
}

Snapshot reading(int64_t index, idf::Data value) {
  return {*MemoryId::parse("Sensors/Range/robot/front"),
          example_time(index),
          {{idf::Dict{{"value", std::move(value)}}, {}}}};
}

TEST_F(RecorderTest, StoresValuesAsTheTypeOfTheirSegmentHasThem) {
  auto recorder = *Recorder::open(store(), {});
  const MemoryId core = *MemoryId::parse("Sensors/Range");
  ASSERT_OK(recorder.declare(core, reading_type()));
  ASSERT_OK(recorder.commit({{reading(0, 2.5f)}}));
  ASSERT_OK(recorder.commit({{reading(1, int32_t{3})}}));
  ASSERT_OK(recorder.commit({{reading(2, 0.1)}}));
  const RecordingCounters& counters = recorder.counters().begin()->second;
  EXPECT_EQ(counters.reinterpreted, 1u) << "0.1 was rounded; 3 was not";
  EXPECT_NE(counters.last_reinterpretation.find("value"), std::string::npos);
  ASSERT_OK(recorder.close());
  const auto reader = *StoreReader::open(store());
  const auto found = read_all(*reader, reading(0, 0).entity);
  ASSERT_OK(found);
  ASSERT_EQ(found->size(), 3u);
  const float expected[] = {2.5f, 3, 0.1f};
  for (size_t i = 0; i < 3; ++i)
    EXPECT_EQ((*found)[i].instances[0].data, (idf::Dict{{"value", expected[i]}}));
  EXPECT_EQ(*reader->manifest().types.find(core), reading_type());
}

TEST_F(RecorderTest, RefusesAWholeCommitWhereAValueBreaksItsType) {
  auto recorder = *Recorder::open(store(), {});
  ASSERT_OK(recorder.declare(*MemoryId::parse("Sensors/Range"), reading_type()));
  const Snapshot broken = reading(1, "far");
  EXPECT_FAILS(recorder.commit({{frame(0), broken}}), StatusCode::kInvalidArgument, "'value'");
  EXPECT_FAILS(recorder.commit({{reading(1, 11.0f)}}), StatusCode::kInvalidArgument, "'value'");
  ASSERT_OK(recorder.close());
  EXPECT_TRUE((*StoreReader::open(store()))->entities().empty());
}

TEST_F(RecorderTest, LetsNoWrongSnapshotPastByEitherRoad) {
  auto recorder = *Recorder::open(store(), {});
  ASSERT_OK(recorder.declare(*MemoryId::parse("Sensors/Range"), reading_type()));
  SegmentTypes any, text;
  ASSERT_OK(text.declare(*MemoryId::parse("Sensors/Range"),
                         idf::Type::object("Said", {{"value", idf::Type::string()}})));
  const Snapshot wrong = reading(1, "far");
  // What was checked where there was no type, or another one, is checked again.
  for (const SegmentTypes& types : {any, text}) {
    const auto checked = CheckedSnapshot::check(wrong, types);
    ASSERT_OK(checked);
    const CheckedSnapshot* update = checked->snapshot.get();
    const Status by_proof = recorder.commit_checked({&update, 1});
    EXPECT_FAILS(by_proof, StatusCode::kInvalidArgument, "'value'");
    EXPECT_EQ(by_proof.message(), recorder.commit({{wrong}}).message());
  }
  EXPECT_FAILS(CheckedSnapshot::check(wrong, recorder.types()), StatusCode::kInvalidArgument,
               "'value'");
  ASSERT_OK(recorder.close());
  EXPECT_TRUE((*StoreReader::open(store()))->entities().empty());
}

TEST_F(RecorderTest, StoresTheSameByBothRoads) {
  const MemoryId core = *MemoryId::parse("Sensors/Range");
  std::vector<Snapshot> stored;
  for (const bool is_checked : {false, true}) {
    const std::filesystem::path path = scratch_ / (is_checked ? "checked" : "direct");
    auto recorder = *Recorder::open(path, {});
    ASSERT_OK(recorder.declare(core, reading_type()));
    const Snapshot given = reading(1, int32_t{3});
    if (is_checked) {
      const auto checked = CheckedSnapshot::check(given, recorder.types());
      ASSERT_OK(checked);
      const CheckedSnapshot* updates[] = {checked->snapshot.get()};
      ASSERT_OK(recorder.commit_checked(updates));
      const CheckedSnapshot* twice[] = {updates[0], updates[0]};
      EXPECT_FAILS(recorder.commit_checked(twice), StatusCode::kInvalidArgument, "twice");
    } else {
      ASSERT_OK(recorder.commit({{given}}));
    }
    ASSERT_OK(recorder.close());
    const auto reader = *StoreReader::open(path);
    const auto found = read_all(*reader, given.entity);
    ASSERT_OK(found);
    ASSERT_EQ(found->size(), 1u);
    stored.push_back(found->front());
  }
  EXPECT_EQ(stored[0], stored[1]);
  EXPECT_EQ(stored[0].instances[0].data, (idf::Dict{{"value", 3.0f}}));
}

TEST_F(RecorderTest, KnowsTheTypesOfEarlierSessions) {
  {
    auto recorder = *Recorder::open(store(), {});
    ASSERT_OK(recorder.declare(*MemoryId::parse("Sensors/Range"), reading_type()));
  }
  auto recorder = *Recorder::open(store(), {});
  EXPECT_FAILS(recorder.commit({{reading(1, "far")}}), StatusCode::kInvalidArgument, "'value'");
}

}  // namespace
}  // namespace engram::ltm
