// SPDX-License-Identifier: Apache-2.0
// What a running memory forgets does not come back, from wherever it was.
#include "memory/live/live_forgetting.h"

#include <gmock/gmock.h>

#include <fstream>
#include <future>
#include <iterator>
#include <thread>

#include "ltm/recording/recording_config.h"
#include "ltm/store/night_lock.h"
#include "ltm/store/store_reader.h"
#include "tests/memory/live/served_memory.h"

namespace engram::memory {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::ServedMemory;
using ::testing::SizeIs;

constexpr const char* kCup = "A/b/c/cup";
constexpr const char* kBed = "A/b/c/bed";
constexpr const char* kCanary = "canary-that-nobody-may-find-again";

ForgetRequest request(const std::vector<std::string>& targets) {
  ForgetRequest request;
  request.targets = targets;
  return request;
}

/// Whether any file below a folder has these bytes.
bool has_bytes(const std::filesystem::path& folder, const std::string& bytes) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string content((std::istreambuf_iterator<char>(file)), {});
    if (content.find(bytes) != std::string::npos) return true;
  }
  return false;
}

/// With a store of which half is sealed, a part is in the journal, and the rest is held or waits.
class LiveForgetting : public ::testing::Test {
 protected:
  void SetUp() override {
    service_.options.memory.all.snapshots = 8;
    service_.open();
  }

  void fill() {
    for (int64_t at = 1; at <= 6; ++at) ASSERT_OK(service_.commit_durably(cup(at)));
    for (int64_t at = 7; at <= 12; ++at) ASSERT_OK(service_->commit(cup(at)));
    for (int64_t at = 1; at <= 3; ++at) ASSERT_OK(service_->commit(ServedMemory::commit(kBed, at)));
  }

  /// What is held was made of what is stored alone, and that of a cup.
  void make_of() {
    const auto made_of = [](const std::string& entity, int64_t at, const std::string& origin) {
      ltm::Commit made = ServedMemory::commit(entity, at, std::string(kCanary) + " made of");
      made.updates[0].instances[0].metadata.origin = *ltm::MemoryId::parse(origin);
      made.updates[0].instances[0].metadata.recipe = "{}";
      return made;
    };
    const std::string at4 = "/1970-01-01 00:00:00.000000004/0";
    ASSERT_OK(service_.commit_durably(made_of("M/b/c/stored", 4, kCup + at4)));
    service_.close();
    service_.open();
    ASSERT_OK(service_->commit(made_of("M/b/c/held", 4, "M/b/c/stored" + at4)));
    ASSERT_OK(service_->commit(ServedMemory::commit("M/b/c/held", 5)));
  }

  static ltm::Commit cup(int64_t at) {
    return ServedMemory::commit(kCup, at,
                                idf::Data(at % 2 == 0 ? fmt::format("{}-{}", kCanary, at)
                                                      : fmt::format("harmless {}", at)));
  }

  Result<ForgetOutcome> forget(const std::vector<std::string>& targets, bool erases = false) {
    ForgetRequest what = request(targets);
    what.erases = erases;
    return service_->forget(what);
  }

  [[nodiscard]] std::filesystem::path store() const { return service_.options.store->store; }

  ServedMemory service_;
};

TEST_F(LiveForgetting, NothingIsAnsweredOrStoredAnyMore) {
  fill();
  const auto done = forget({"A/b/c/cup @ time:4..9"});
  ASSERT_OK(done);
  EXPECT_EQ(done->snapshots, 6u);
  ASSERT_EQ(done->entities.size(), 1u);
  EXPECT_EQ(done->entities[0].entity.to_string(), kCup);
  EXPECT_EQ(to_ns(done->entities[0].first), 4);
  EXPECT_EQ(to_ns(done->entities[0].last), 9);
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 2, 3, 10, 11, 12));
  EXPECT_THAT(*service_.ask("?ids A/b/c/cup @ all"), ElementsAre(1, 2, 3, 10, 11, 12));
  EXPECT_THAT(*service_.ask("A/b/c/cup @ index:0..3"), ElementsAre(1, 2, 3, 10));
  EXPECT_THAT(*service_.ask("A/b/c/cup @ nearest:6"), ElementsAre(3));
  EXPECT_THAT(*service_.ask("A/b/c/bed @ all"), ElementsAre(1, 2, 3));
  service_.close();
  service_.open();
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 2, 3, 10, 11, 12));
  EXPECT_THAT(*service_.ask("A/b/c/bed @ all"), ElementsAre(1, 2, 3));
}

TEST_F(LiveForgetting, ErasingLeavesNoByteOfIt) {
  fill();
  ASSERT_OK(service_.ask("A/b/c/cup @ all"));  // Decoded and kept.
  const auto done = forget({"A/b/c/cup @ all"}, true);
  ASSERT_OK(done);
  EXPECT_EQ(done->snapshots, 12u);
  ASSERT_TRUE(done->erased.has_value());
  EXPECT_TRUE(std::filesystem::exists(store() / done->erased->report));
  EXPECT_FALSE(has_bytes(store(), kCanary));
  EXPECT_EQ(service_.ask("A/b/c/cup @ all").status().code(), StatusCode::kNotFound);
  EXPECT_THAT(*service_.ask("A @ all"), ElementsAre(1, 2, 3));
  ASSERT_OK(service_->close());
  EXPECT_FALSE(has_bytes(store(), kCanary));
  EXPECT_FALSE(has_bytes(store(), "harmless"));
}

TEST_F(LiveForgetting, CanariesAreFoundAsLongAsNobodyForgets) {
  fill();
  ASSERT_OK(service_->close());
  EXPECT_TRUE(has_bytes(store(), kCanary));
}

TEST_F(LiveForgetting, WhatWaitsIsToldAndNeverStored) {
  service_.close();
  service_.options.store_interval = std::chrono::hours(1);
  service_.open();
  std::vector<ltm::Admission> waiting;
  for (int64_t at = 1; at <= 4; ++at) {
    auto admission = service_->commit(cup(at), {}, MemoryService::Durability::kJournal);
    ASSERT_OK(admission);
    waiting.push_back(*std::move(admission));
  }
  const auto done = forget({"A/b/c/cup/1970-01-01 00:00:00.000000002"}, true);
  ASSERT_OK(done);
  EXPECT_EQ(done->from_memory, 1u);
  EXPECT_EQ(done->never_stored, 1u);
  EXPECT_EQ(done->from_store, 0u);
  EXPECT_FAILS(service_->wait_stored(waiting[1]), StatusCode::kCancelled, "forgotten");
  for (const size_t other : {0, 2, 3}) EXPECT_OK(service_->wait_stored(waiting[other]));
  ASSERT_OK(service_->close());
  EXPECT_FALSE(has_bytes(store(), fmt::format("{}-2", kCanary)));
  EXPECT_TRUE(has_bytes(store(), fmt::format("{}-4", kCanary)));
  service_.close();
  service_.open();
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 3, 4));
}

TEST_F(LiveForgetting, PredictionsDoNotContinueIt) {
  const auto number = [](int64_t at, double x) {
    return ServedMemory::commit("N/b/c/d", at * 1'000'000, idf::Data(x));
  };
  for (int64_t at = 1; at <= 40; ++at)
    ASSERT_OK(service_.commit_durably(number(at, at <= 20 ? 1.0 : 1e6 + 1e3 * at)));
  const auto entity = *ltm::MemoryId::parse("N/b/c/d");
  const std::vector<Duration> ahead{std::chrono::milliseconds(1), std::chrono::milliseconds(5)};
  std::vector<std::string> engines;
  const auto predicted = [&](const std::string& engine) {
    std::vector<double> values;
    const auto all = service_->predict(entity, {{}, ahead, engine});
    EXPECT_OK(all);
    if (all.ok())
      for (const ltm::SnapshotResult& one : *all)
        values.push_back(*one.instances.at(0).data.get_if<double>());
    return values;
  };
  const auto before = service_->engines(entity, ahead[0], {});
  ASSERT_OK(before);
  for (const ltm::EngineRecord& record : *before) {
    engines.push_back(record.engine);
    EXPECT_GT(predicted(record.engine).front(), 1e5) << record.engine;
  }
  ASSERT_GT(engines.size(), 1u);
  ASSERT_OK(forget({"N/b/c/d @ after:20500000, time:20500000..90000000"}));
  for (const std::string& engine : engines)
    for (const double value : predicted(engine)) EXPECT_NEAR(value, 1.0, 0.1) << engine;
  const auto after = service_->engines(entity, ahead[0], {});
  ASSERT_OK(after);
  for (const ltm::EngineRecord& record : *after)
    EXPECT_LT(record.mean.number_mse, 1.0) << record.engine;
}

// What comes after it is as it was, so only what engines learned could tell of it.
TEST_F(LiveForgetting, EnginesLearnAnewWithoutIt) {
  const auto number = [](int64_t at) {
    return ServedMemory::commit("N/b/c/d", at * 1'000'000,
                                idf::Data(at > 20 && at <= 30 ? 1e6 * at : 1.0));
  };
  for (int64_t at = 1; at <= 50; ++at) ASSERT_OK(service_.commit_durably(number(at)));
  const auto entity = *ltm::MemoryId::parse("N/b/c/d");
  const Duration ahead = std::chrono::milliseconds(1);
  const auto max_error = [&] {
    double max = 0;
    const auto all = service_->engines(entity, ahead, {});
    EXPECT_OK(all);
    if (all.ok())
      for (const ltm::EngineRecord& record : *all) max = std::max(max, record.mean.number_mse);
    return max;
  };
  ASSERT_OK(service_.ask("N @ all"));
  EXPECT_GT(max_error(), 1e6);
  EXPECT_GT(service_->counters().reading.decoded_bytes, 0u);
  ASSERT_OK(forget({"N @ time:20500000..30500000"}));
  EXPECT_EQ(service_->counters().reading.decoded_bytes, 0u);
  EXPECT_LT(max_error(), 1.0);
}

TEST_F(LiveForgetting, WhatAFilterHoldsIsForgottenToo) {
  service_.close();
  auto recording = ltm::parse_recording_config(
      "entities:\n  - match: A\n    filters:\n"
      "      - trigger: {events: [{entity: X/.*/.*/.*}], before: 10s}\n",
      "filters");
  ASSERT_OK(recording);
  recording->store = service_.options.store->recording.store;
  service_.options.store->recording = *std::move(recording);
  service_.options.memory.all.snapshots = 1;
  service_.open();
  for (int64_t at = 1; at <= 6; ++at) ASSERT_OK(service_.commit_durably(cup(at)));
  // Working memory has the last one, the filter has all of them, and the store none.
  ASSERT_THAT(*service_.ask("A/b/c/cup @ all"), SizeIs(1));
  const auto done = forget({"A/b/c/cup @ time:2..2, time:4..4", "A/b/c/cup @ latest"}, true);
  ASSERT_OK(done);
  EXPECT_EQ(done->snapshots, 3u);
  // The event lets the filter keep what it still holds.
  ASSERT_OK(service_.commit_durably(ServedMemory::commit("X/b/c/door", 7)));
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 3, 5));
  ASSERT_OK(service_->close());
  EXPECT_FALSE(has_bytes(store(), kCanary));
  service_.close();
  service_.open();
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 3, 5));
}

TEST_F(LiveForgetting, NothingIsComparedWithIt) {
  service_.close();
  auto recording =
      ltm::parse_recording_config("entities: [{match: A, filters: [equality: {}]}]\n", "filters");
  ASSERT_OK(recording);
  recording->store = service_.options.store->recording.store;
  service_.options.store->recording = *std::move(recording);
  service_.open();
  const auto same = [](int64_t at) { return ServedMemory::commit(kCup, at, int64_t{5}); };
  ASSERT_OK(service_.commit_durably(same(1)));
  ASSERT_OK(forget({kCup}));
  ASSERT_OK(service_.commit_durably(same(2)));
  ASSERT_OK(service_.commit_durably(same(3)));
  service_.close();
  service_.open();
  EXPECT_THAT(*service_.ask("A @ all"), ElementsAre(2)) << "the second is new, the third is not";
}

TEST_F(LiveForgetting, WhatWasMadeOfItGoesTooIfItIsErased) {
  fill();
  make_of();
  const auto kept = service_.ask("M @ all");
  EXPECT_THAT(*kept, ElementsAre(4, 5, 4));
  const auto done = forget({"A/b/c/cup @ all"}, true);
  ASSERT_OK(done);
  EXPECT_EQ(done->snapshots, 14u);
  EXPECT_THAT(*service_.ask("M @ all"), ElementsAre(5));
  ASSERT_OK(service_->close());
  EXPECT_FALSE(has_bytes(store(), kCanary));
}

TEST_F(LiveForgetting, OnlyCountsIfItIsToldTo) {
  fill();
  ForgetRequest what = request({"A/b/c/cup @ latest:3", "A/b/c/bed"});
  what.is_dry_run = true;
  what.on_forgotten = [](const ltm::ForgetSet&) { ADD_FAILURE() << "forgot something"; };
  const auto counted = service_->forget(what);
  ASSERT_OK(counted);
  EXPECT_EQ(counted->snapshots, 6u);
  EXPECT_EQ(counted->from_memory, 0u);
  EXPECT_THAT(*service_.ask("A @ all"), SizeIs(15));
  EXPECT_EQ(service_->counters().memory.forgotten, 0u);
}

TEST_F(LiveForgetting, SaysWhatNamesNothingAndChangesNothing) {
  fill();
  EXPECT_FAILS(forget({kBed, "A/b/c/none"}), StatusCode::kNotFound, "'A/b/c/none' names no");
  EXPECT_FAILS(forget({"A/b/c/cup @ time:50..60"}), StatusCode::kNotFound, "names no snapshot");
  EXPECT_FAILS(forget({"A/b/c/cup @ +1s"}), StatusCode::kNotFound, "names no snapshot");
  EXPECT_THAT(*service_.ask("A @ all"), SizeIs(15));
}

TEST_F(LiveForgetting, ForgetsWithoutAStore) {
  service_.close();
  service_.options.store.reset();
  service_.options.memory.mode = ltm::StoreMode::kLatest;
  service_.open();
  for (int64_t at = 1; at <= 6; ++at) ASSERT_OK(service_->commit(cup(at)));
  const auto done = forget({"A/b/c/cup @ latest:2"}, true);
  ASSERT_OK(done);
  EXPECT_EQ(done->from_memory, 2u);
  EXPECT_EQ(done->from_store, 0u);
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 2, 3, 4));
}

/// Sees the windows of some entities.
class Windows final : public ltm::View {
 public:
  [[nodiscard]] ltm::Sight of(const ltm::MemoryId& entity) const override {
    ltm::Sight sight;
    if (entity.to_string() == kCup) sight.times.add({time_from_ns(3), time_from_ns(8)});
    return sight;
  }
};

TEST_F(LiveForgetting, TakesOnlyWhatMayBeErased) {
  fill();
  ForgetRequest what = request({"A @ all"});
  what.view = std::make_shared<Windows>();
  const auto done = service_->forget(what);
  ASSERT_OK(done);
  EXPECT_EQ(done->snapshots, 6u);
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 2, 9, 10, 11, 12));
  EXPECT_THAT(*service_.ask("A/b/c/bed @ all"), ElementsAre(1, 2, 3));
  what = request({kBed});
  what.view = std::make_shared<Windows>();
  EXPECT_FAILS(service_->forget(what), StatusCode::kNotFound, "that may be erased");
}

TEST_F(LiveForgetting, CountsWhatWasMadeOfItAlsoWithoutForgetting) {
  service_.close();
  // What is held is not stored by itself meanwhile.
  service_.options.store_interval = std::chrono::hours(1);
  service_.open();
  fill();
  make_of();
  ForgetRequest what = request({"A/b/c/cup @ time:4..4"});
  what.erases = true;
  what.is_dry_run = true;
  EXPECT_EQ(service_->forget(what)->snapshots, 3u);
  what.is_dry_run = false;
  EXPECT_EQ(service_->forget(what)->snapshots, 3u);
}

TEST_F(LiveForgetting, TellsNothingOfWhatIsHiddenFromWhoErases) {
  fill();
  make_of();
  ForgetRequest what = request({"A/b/c/cup @ time:4..4"});
  what.view = std::make_shared<Windows>();
  what.erases = true;
  std::string progress;
  what.progress = [&progress](const Progress& told) {
    progress.append(told.what).append(told.detail).append("\n");
  };
  const auto done = service_->forget(what);
  ASSERT_OK(done);
  EXPECT_EQ(done->snapshots, 1u);
  EXPECT_LE(done->from_memory, 1u);
  EXPECT_LE(done->from_store, 1u);
  ASSERT_EQ(done->entities.size(), 1u);
  EXPECT_EQ(done->entities[0].entity.to_string(), kCup);
  EXPECT_THAT(progress, ::testing::HasSubstr("forget"));
  for (const char* hidden : {"M/", "stored", "held", "store.engram"})
    EXPECT_THAT(progress, ::testing::Not(::testing::HasSubstr(hidden)));
  ASSERT_TRUE(done->erased.has_value());
  EXPECT_TRUE(done->erased->files.empty());
  for (const auto& [entity, erased] : done->erased->entities) EXPECT_EQ(entity.to_string(), kCup);
  // It went all the same.
  EXPECT_THAT(*service_.ask("M @ all"), ElementsAre(5));
}

TEST_F(LiveForgetting, OthersGoOnToCommitAndAsk) {
  fill();
  std::jthread committing([this](const std::stop_token& stop) {
    for (int64_t at = 100; !stop.stop_requested(); ++at) {
      ASSERT_OK(service_->commit(ServedMemory::commit("B/b/c/d", at)));
      ASSERT_OK(service_.ask("B/b/c/d @ latest:3"));
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  std::jthread storing([this](const std::stop_token& stop) {
    for (int64_t at = 1; !stop.stop_requested(); ++at) {
      ASSERT_OK(service_.commit_durably(ServedMemory::commit("B/b/c/e", at)));
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  for (int64_t round = 0; round < 5; ++round) {
    ASSERT_OK(forget({"A/b/c/cup @ latest:2"}, round % 2 == 0));
    EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), SizeIs(static_cast<size_t>(10 - 2 * round)));
  }
  committing = {};
  storing = {};
  const size_t count = service_.ask("B @ all")->size();
  ASSERT_OK(service_->close());
  service_.close();
  service_.open();
  EXPECT_THAT(*service_.ask("B @ all"), SizeIs(count));
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), ElementsAre(1, 2));
}

TEST_F(LiveForgetting, OneAtATimeAndClosingStopsIt) {
  fill();
  ForgetRequest what = request({kCup});
  std::promise<void> begun;
  std::promise<void> go_on;
  Status second;
  what.on_forgotten = [&](const ltm::ForgetSet&) {
    begun.set_value();
    go_on.get_future().wait();
  };
  std::optional<Result<ForgetOutcome>> first;
  std::jthread forgetting([&] { first = service_->forget(what); });
  begun.get_future().wait();
  EXPECT_FAILS(forget({kBed}), StatusCode::kFailedPrecondition, "is forgetting already");
  std::jthread closing([&] { EXPECT_OK(service_->close()); });
  // It is closed when it refuses commits, and then waits.
  while (service_->commit(ServedMemory::commit("B/b/c/d", 1)).ok()) std::this_thread::yield();
  go_on.set_value();
  forgetting.join();
  closing.join();
  EXPECT_FAILS(*first, StatusCode::kCancelled, "carries on");
  EXPECT_FAILS(forget({kBed}), StatusCode::kUnavailable, "is stopping");
  // What was carried out stays, and the same request does the rest.
  service_.close();
  service_.open();
  ASSERT_OK(forget({"A"}));
  EXPECT_EQ(service_.ask("A @ all").status().code(), StatusCode::kNotFound);
}

TEST_F(LiveForgetting, ACallerStopsIt) {
  fill();
  std::stop_source stop;
  ForgetRequest what = request({kCup});
  what.stop = stop.get_token();
  stop.request_stop();
  EXPECT_FAILS(service_->forget(what), StatusCode::kCancelled, "nothing was changed");
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), SizeIs(12));
}

TEST_F(LiveForgetting, ErasesNothingWhileAnotherLearns) {
  fill();
  const auto night = ltm::NightLock::of_learning(store());
  ASSERT_OK(night);
  EXPECT_FAILS(forget({kCup}, true), StatusCode::kFailedPrecondition, "learns or erases");
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), SizeIs(12));
  EXPECT_OK(forget({kCup}));
}

TEST_F(LiveForgetting, SaysWhenItCannotCodeAnew) {
  fill();
  ASSERT_OK(ltm::edit_manifest(store(), [](ltm::Manifest& manifest) -> Status {
    manifest.models.push_back({.entity = *ltm::MemoryId::parse(kBed), .version = 1});
    return {};
  }));
  EXPECT_FAILS(forget({kCup}, true), StatusCode::kFailedPrecondition, "has 1 models");
  EXPECT_THAT(*service_.ask("A/b/c/cup @ all"), SizeIs(12));
}

}  // namespace
}  // namespace engram::memory
