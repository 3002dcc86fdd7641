// SPDX-License-Identifier: Apache-2.0
// Rules, filters that hold snapshots back, and late snapshots, through the whole recorder.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "ltm/recording/recording_config.h"
#include "ltm/store/store_reader.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

Snapshot at(double seconds, const std::string& name, idf::Data value = 1.0) {
  return {example_entity(name),
          time_from_ns(kExampleStart_ns) + *duration_from_seconds(seconds),
          {{std::move(value), example_metadata(0)}}};
}

class RecordingFilters : public ::testing::Test {
 protected:
  Recorder open(std::string_view config,
                std::function<void(const MemoryId&)> on_released = nullptr) {
    auto options = parse_recording_config(config, "test.yaml");
    EXPECT_OK(options);
    options->on_released = std::move(on_released);
    auto recorder = Recorder::open(store(), *options, [this] { return now_; });
    EXPECT_OK(recorder);
    return *std::move(recorder);
  }
  /// Seconds of what the store has of an entity.
  std::vector<double> stored(const std::string& name) {
    const auto reader = *StoreReader::open(store());
    std::vector<double> seconds;
    const auto all = read_all(*reader, example_entity(name));
    if (!all.ok()) return seconds;
    for (const Snapshot& each : *all)
      seconds.push_back(to_seconds(each.time - time_from_ns(kExampleStart_ns)));
    return seconds;
  }
  EntitySummary summary(const std::string& name) {
    return *(*StoreReader::open(store()))->summary(example_entity(name));
  }
  static void expect_balance(const Recorder& recorder) {
    for (const auto& [entity, each] : recorder.counters()) {
      uint64_t dropped = 0;
      for (const auto& [filter, count] : each.dropped_by) dropped += count;
      EXPECT_EQ(each.offered, each.kept + dropped + each.held.snapshots + each.failed)
          << entity.to_string();
    }
  }
  [[nodiscard]] std::filesystem::path store() const { return scratch_ / "store"; }

  ScratchDirectory scratch_;
  Time now_ = time_from_ns(kExampleStart_ns);
};

constexpr const char* kTwoRules = R"(
entities:
  - match: .*/.*/.*/cam
    name: cameras
    filters: [{frequency: {rate: 1Hz}}, equality]
  - match: .*
    filters: [equality]
)";

TEST_F(RecordingFilters, GivesEachEntityTheFirstRuleThatMatches) {
  auto recorder = open(kTwoRules);
  for (int i = 0; i < 40; ++i)
    ASSERT_OK(recorder.commit({{at(i / 4.0, "cam", i / 8), at(i / 4.0, "arm", i / 8)}}));
  const RecordingCounters& cam = recorder.counters().at(example_entity("cam"));
  const RecordingCounters& arm = recorder.counters().at(example_entity("arm"));
  EXPECT_EQ(cam.rule, "cameras");
  EXPECT_EQ(arm.rule, ".*");
  ASSERT_EQ(cam.filters.size(), 2u);
  EXPECT_EQ(cam.filters[0].dropped_by.at("rate"), 30u);
  EXPECT_EQ(cam.filters[1].offered, 10u);
  EXPECT_EQ(cam.filters[1].dropped_by.at("equal"), 5u);
  EXPECT_EQ(cam.dropped_by.at("frequency"), 30u);
  EXPECT_EQ(cam.kept, 5u);
  EXPECT_EQ(arm.kept, 5u);
  expect_balance(recorder);
  ASSERT_OK(recorder.close());
  EXPECT_EQ(stored("cam"), (std::vector<double>{0, 2, 4, 6, 8}));
  EXPECT_EQ(summary("cam").offered, 40u);
  EXPECT_EQ(summary("arm").offered, 40u);
}

TEST_F(RecordingFilters, StoresWhatWasHeldWhenAnotherEntityTriggers) {
  const std::string config = R"(
entities:
  - match: .*/.*/.*/cam
    filters:
      - trigger: {events: [{entity: .*/.*/.*/force, path: z, bound: 10}], before: 2s, after: 1s}
)";
  std::vector<MemoryId> released;
  auto recorder = open(config, [&](const MemoryId& snapshot) { released.push_back(snapshot); });
  for (int i = 0; i < 20; ++i) {
    ASSERT_OK(recorder.commit({{at(i, "cam", i)}}));
    ASSERT_OK(recorder.commit({{at(i + 0.5, "force", idf::Dict{{"z", i == 9 ? 50.0 : 0.0}})}}));
    expect_balance(recorder);
  }
  // Triggered at 9.5.
  EXPECT_EQ(stored("cam"), (std::vector<double>{8, 9, 10}));
  // The snapshot of 10 is stored by its own commit.
  EXPECT_EQ(released, (std::vector{at(8, "cam").id(), at(9, "cam").id()}));
  const RecordingCounters& cam = recorder.counters().at(example_entity("cam"));
  EXPECT_EQ(cam.kept, 3u);
  EXPECT_EQ(cam.held.snapshots, 3u);
  EXPECT_GT(cam.held.bytes, 0u);
  EXPECT_EQ(cam.filters[0].held.snapshots, 3u);
  ASSERT_OK(recorder.close());
  EXPECT_EQ(recorder.counters().at(example_entity("cam")).held.snapshots, 0u);
  expect_balance(recorder);
  EXPECT_EQ(summary("cam").offered, 20u);
  EXPECT_EQ(summary("force").snapshots, 20u);
}

TEST_F(RecordingFilters, KnowsEventsThatCameBeforeAnEntitysFirstSnapshot) {
  auto recorder = open(R"(
entities:
  - match: .*/.*/.*/cam
    filters: [{importance: {events: [{entity: .*/.*/.*/grasp}], before: 1s, after: 3s}}]
)");
  ASSERT_OK(recorder.commit({{at(0, "grasp")}}));
  for (int i = 1; i < 10; ++i) ASSERT_OK(recorder.commit({{at(i, "cam", i)}}));
  ASSERT_OK(recorder.close());
  EXPECT_EQ(stored("cam"), (std::vector<double>{1, 2, 3}));
}

TEST_F(RecordingFilters, KeepsWhatIsAroundAFailureThatAnEnumTells) {
  auto recorder = open(R"(
entities:
  - match: .*/.*/.*/cam
    filters: [{importance: {events: [{entity: Skill, tells: [failure]}], before: 1s, after: 2s}}]
)");
  ASSERT_OK(recorder.declare(
      *MemoryId::parse("Skill/Event"),
      idf::Type::object(
          "Action",
          {{"outcome", idf::Type::int_enum("Outcome", {{"SUCCESS", 1}, {"FAILURE", 2}})}})));
  const auto acts = [](double seconds, int32_t outcome) {
    Snapshot snapshot = at(seconds, "pick", idf::Dict{{"outcome", outcome}});
    snapshot.entity = *MemoryId::parse("Skill/Event/robot/pick");
    return snapshot;
  };
  for (int i = 0; i < 20; ++i) {
    ASSERT_OK(recorder.commit({{at(i, "cam", i)}}));
    if (i == 5) ASSERT_OK(recorder.commit({{acts(i, 1)}}));
    if (i == 12) ASSERT_OK(recorder.commit({{acts(i, 2)}}));
  }
  ASSERT_OK(recorder.close());
  EXPECT_EQ(stored("cam"), (std::vector<double>{11, 12, 13, 14}));
}

TEST_F(RecordingFilters, StoresHeldSnapshotsThoughTheCommitThatFreesThemFails) {
  auto recorder = open(R"(
entities:
  - match: .*/.*/.*/cam
    filters: [{importance: {events: [{entity: .*/.*/.*/grasp}], before: 5s}}]
)");
  for (int i = 0; i < 3; ++i) ASSERT_OK(recorder.commit({{at(i, "cam", i)}}));
  EXPECT_FAILS(recorder.commit({{at(3, "grasp", nested_lists(100))}}), StatusCode::kInvalidArgument,
               "nests deeper");
  expect_balance(recorder);
  EXPECT_EQ(recorder.counters().at(example_entity("grasp")).failed, 1u);
  EXPECT_EQ(recorder.counters().at(example_entity("cam")).kept, 3u);
  ASSERT_OK(recorder.close());
  EXPECT_EQ(stored("cam"), (std::vector<double>{0, 1, 2}));
  EXPECT_TRUE(stored("grasp").empty());
}

TEST_F(RecordingFilters, RefusesLateSnapshotsWhereToldTo) {
  auto recorder = open("recording: {late: refuse}\n");
  ASSERT_OK(recorder.commit({{at(5, "cam")}}));
  EXPECT_FAILS(recorder.commit({{at(4, "cam")}}), StatusCode::kInvalidArgument, "backwards");
  EXPECT_EQ(recorder.counters().at(example_entity("cam")).offered, 1u);
}

TEST_F(RecordingFilters, CountsLateSnapshotsThatPassTheFilters) {
  auto recorder = open("entities: [{match: .*, filters: [{frequency: {rate: 1Hz}}]}]\n");
  ASSERT_OK(recorder.commit({{at(5, "cam")}}));
  ASSERT_OK(recorder.commit({{at(4.9, "cam")}}));
  const RecordingCounters& cam = recorder.counters().at(example_entity("cam"));
  EXPECT_EQ(cam.late, 1u);
  EXPECT_EQ(cam.filters[0].offered, 1u);
  EXPECT_EQ(cam.kept, 2u);
  expect_balance(recorder);
}

TEST_F(RecordingFilters, EncodesTheSameOnAnyNumberOfThreads) {
  std::vector<uint64_t> bytes;
  for (const int threads : {1, 4}) {
    const auto path = scratch_ / std::to_string(threads);
    auto recorder = *Recorder::open(path, {.threads = threads});
    for (int64_t i = 0; i < 5; ++i) {
      Commit commit;
      for (int64_t c = 0; c < 6; ++c)
        commit.updates.push_back(at(static_cast<double>(i), "cam" + std::to_string(c),
                                    example_image(120, 160, 3, i * 10 + c)));
      ASSERT_OK(recorder.commit(commit));
    }
    uint64_t total = 0;
    for (const auto& [entity, counters] : recorder.counters()) total += counters.stored_bytes;
    bytes.push_back(total);
    const auto reader = *StoreReader::open(path);
    for (int64_t c = 0; c < 6; ++c) {
      const auto all = *read_all(*reader, example_entity("cam" + std::to_string(c)));
      ASSERT_EQ(all.size(), 5u);
      for (int64_t i = 0; i < 5; ++i)
        EXPECT_EQ(all[static_cast<size_t>(i)].instances[0].data,
                  idf::Data(example_image(120, 160, 3, i * 10 + c)));
    }
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST_F(RecordingFilters, NotesDropsInTheStoreBeforeItIsKilled) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    auto recorder = open("entities: [{match: .*, filters: [equality]}]\n");
    for (int i = 0; i < 100; ++i) {
      now_ += std::chrono::milliseconds(100);
      if (!recorder.commit({{at(i / 10.0, "cam")}}).ok()) ::_exit(1);
    }
    ::raise(SIGKILL);
  }
  int outcome = 0;
  ::waitpid(child, &outcome, 0);
  ASSERT_TRUE(WIFSIGNALED(outcome));
  // Ten seconds with a note every five: all but those after the last note are there.
  EXPECT_EQ(summary("cam").snapshots, 1u);
  EXPECT_EQ(summary("cam").offered, 100u);
}

TEST_F(RecordingFilters, CountsWhatItDropsUnmadeAsAnyOther) {
  auto recorder = open(kTwoRules);
  const uint64_t bytes = at(0, "cam").raw_bytes();
  for (int i = 0; i < 12; ++i) {
    const Snapshot made = at(i / 4.0, "cam", static_cast<double>(i));
    const bool is_dropped = recorder.drop_unmade(made.entity, made.time, bytes);
    EXPECT_EQ(is_dropped, i % 4 != 0) << i;
    EXPECT_FALSE(recorder.drop_unmade(example_entity("other"), made.time, bytes));
    if (is_dropped) continue;
    EXPECT_OK(recorder.commit({{made}}));
  }
  expect_balance(recorder);
  const RecordingCounters& counters = recorder.counters().at(example_entity("cam"));
  EXPECT_EQ(counters.offered, 12u);
  EXPECT_EQ(counters.offered_bytes, 12 * bytes);
  EXPECT_EQ(counters.dropped_by.at("frequency"), 9u);
  EXPECT_OK(recorder.close());
  EXPECT_EQ(stored("cam"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(summary("cam").offered, 12u);
  EXPECT_EQ(summary("cam").offered_bytes, 12 * bytes);
  EXPECT_EQ(summary("cam").dropped_by.at("frequency"), 9u);
}

TEST_F(RecordingFilters, DropsNoSourceOfEventsUnmade) {
  auto recorder = open(R"(
entities:
  - match: .*/.*/.*/arm
    filters: [{trigger: {events: [{entity: .*/.*/.*/cam}], before: 1s}}]
  - match: .*
    filters: [{frequency: {rate: 1Hz}}]
)");
  EXPECT_OK(recorder.commit({{at(0, "arm"), at(0, "cam")}}));
  EXPECT_FALSE(recorder.drop_unmade(example_entity("cam"), at(0.1, "cam").time, 8));
  EXPECT_OK(recorder.commit({{at(0, "free")}}));
  EXPECT_TRUE(recorder.drop_unmade(example_entity("free"), at(0.1, "free").time, 8));
}

constexpr const char* kLinked = R"(
entities:
  - match: .*/.*/.*/event
    filters: []
  - match: .*
    keep_linked: 10s
    filters: [{frequency: {rate: 1Hz}}]
)";

idf::Data link_to(const Snapshot& snapshot) {
  return idf::Dict{{"cause", snapshot.id().instance(0).to_string()}};
}

TEST_F(RecordingFilters, KeepsWhatOthersLinkToAndWhatThatLinksTo) {
  std::vector<MemoryId> released;
  auto recorder = open(kLinked, [&](const MemoryId& id) { released.push_back(id); });
  const Snapshot image = at(0.5, "image");
  const Snapshot object = at(0.6, "object", link_to(image));
  for (const double second : {0.0, 0.1, 0.2, 0.3, 0.4})
    ASSERT_OK(recorder.commit({{at(second, "image"), at(second, "object")}}));
  ASSERT_OK(recorder.commit({{image}}));
  ASSERT_OK(recorder.commit({{object}}));
  // What filters dropped links to nothing that is kept.
  ASSERT_OK(recorder.commit({{at(0.7, "object", link_to(at(0.3, "image")))}}));
  expect_balance(recorder);
  EXPECT_TRUE(released.empty());
  ASSERT_OK(recorder.commit({{at(0.8, "event", link_to(object))}}));
  EXPECT_THAT(released, ::testing::UnorderedElementsAre(image.id(), object.id()));
  expect_balance(recorder);
  // A link to what nobody knows, and to what is too old.
  ASSERT_OK(recorder.commit({{at(0.9, "event", link_to(at(0.4, "nobody")))}}));
  ASSERT_OK(recorder.commit({{at(20, "object"), at(20, "image")}}));
  ASSERT_OK(recorder.commit({{at(20.1, "event", link_to(at(0.2, "object")))}}));
  ASSERT_OK(recorder.close());
  expect_balance(recorder);
  EXPECT_EQ(stored("object"), (std::vector<double>{0, 0.6, 20}));
  EXPECT_EQ(stored("image"), (std::vector<double>{0, 0.5, 20}));
  EXPECT_EQ(summary("image").offered, 7u);
}

TEST_F(RecordingFilters, KeepsAtTheEndWhatHeldSnapshotsLinkTo) {
  auto recorder = open(R"(
entities:
  - match: .*/.*/.*/late
    filters: [{importance: {events: [{entity: a/b/c/d}], base_rate: 1Hz}}]
  - match: .*
    keep_linked: 1min
    filters: [{frequency: {rate: 100mHz}}]
)");
  ASSERT_OK(recorder.commit({{at(0, "image")}}));
  ASSERT_OK(recorder.commit({{at(1, "image")}}));
  ASSERT_OK(recorder.commit({{at(2, "late", link_to(at(1, "image")))}}));
  ASSERT_OK(recorder.close());
  EXPECT_EQ(stored("late"), (std::vector<double>{2}));
  EXPECT_EQ(stored("image"), (std::vector<double>{0, 1}));
}

TEST_F(RecordingFilters, RefusesOptionsThatAreWrong) {
  EXPECT_FAILS(Recorder::open(store(), {.threads = 0}), StatusCode::kInvalidArgument, "0 threads");
  EXPECT_FAILS(Recorder::open(store(), {.drop_note_interval = Duration(-1)}),
               StatusCode::kInvalidArgument, "drop_note_interval");
  EntityRule rule;
  rule.name = "mine";
  rule.filters.emplace_back(FrequencyFilter::Options{.max_rate_hz = 0});
  EXPECT_FAILS(Recorder::open(store(), {.rules = {rule}}), StatusCode::kInvalidArgument,
               "rule 'mine'");
  EXPECT_FALSE(std::filesystem::exists(store()));
}

}  // namespace
}  // namespace engram::ltm
