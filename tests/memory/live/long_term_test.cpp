// SPDX-License-Identifier: Apache-2.0
#include "memory/live/long_term.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "ltm/likeness/make_codes.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/recall/joined_past.h"
#include "ltm/recall/recall.h"
#include "ltm/store/segment_index.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::memory {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* kEntity = "A/b/c/d";

class LongTermTest : public ::testing::Test {
 protected:
  LongTermTest() {
    options.store = folder / "store.engram";
    options.recording.store.min_free_bytes = 0;
    options.recording.store.durability = ltm::Durability::kNone;
  }

  void open() {
    auto opened = LongTerm::open(options);
    ASSERT_OK(opened);
    store = *std::move(opened);
    auto stored = ltm::StorePast::open(options.store, nullptr, {size_t{1} << 20});
    ASSERT_OK(stored);
    reading = stored->get();
    auto joined = ltm::JoinedPast::create("test", *memory, *std::move(stored), store->recorded());
    recall.emplace(std::move(joined),
                   std::make_unique<ltm::AccessLog>(options.store, ltm::AccessLog::Options{}));
  }

  static ltm::SharedSnapshot snapshot(int64_t at, idf::Data data,
                                      const std::string& entity = kEntity) {
    return ltm::hold_untyped(
        {*ltm::MemoryId::parse(entity), time_from_ns(at), {{std::move(data), {}}}});
  }

  std::vector<LongTerm::Refused> record(const std::vector<ltm::SharedSnapshot>& snapshots) {
    std::vector<LongTerm::Refused> refused;
    EXPECT_OK(store->record(snapshots, refused));
    return refused;
  }

  /// Times of what is answered from the store and from what `held` holds from now on.
  Result<std::vector<int64_t>> ask(const std::string& selector,
                                   const std::vector<ltm::SharedSnapshot>& held = {}) {
    for (const ltm::SharedSnapshot& snapshot : held) EXPECT_OK(memory->commit({{*snapshot}}));
    const auto query = *ltm::Query::parse(std::string(kEntity) + " @ " + selector);
    ENGRAM_ASSIGN_OR_RETURN(const auto answer,
                            recall->answer(query, {.max_answer_bytes = options.max_answer_bytes}));
    std::vector<int64_t> times;
    for (const ltm::RecalledSnapshot& one : answer.entities.front().snapshots)
      times.push_back(to_ns(one.answer.time));
    return times;
  }

  ScratchDirectory folder;
  LongTerm::Options options;
  std::unique_ptr<ltm::WorkingMemory> memory =
      *ltm::WorkingMemory::create({.mode = ltm::StoreMode::kLatest});
  std::unique_ptr<LongTerm> store;
  std::optional<ltm::Recall> recall;
  const ltm::StorePast* reading = nullptr;
};

TEST_F(LongTermTest, AnswersFromTheStoreAndFromWhatIsHeld) {
  open();
  record({snapshot(1, int64_t{1}), snapshot(2, int64_t{2})});
  const std::vector<ltm::SharedSnapshot> held = {snapshot(2, int64_t{2}), snapshot(3, int64_t{3})};
  EXPECT_THAT(*ask("latest:2"), ElementsAre(1, 2));
  EXPECT_THAT(*ask("all", held), ElementsAre(1, 2, 3));
  const ltm::RecordedEntities& recorded = store->recorded();
  EXPECT_EQ(recorded.known_until(*ltm::MemoryId::parse(kEntity)), time_from_ns(2));
  EXPECT_EQ(recorded.known_until(*ltm::MemoryId::parse("A/b/c/x")), std::nullopt);
}

TEST_F(LongTermTest, KnowsAtOnceWhatWasRecorded) {
  open();
  for (int64_t at = 1; at <= 20; ++at) {
    record({snapshot(at, at)});
    ASSERT_THAT(*ask("all"), SizeIs(static_cast<size_t>(at)));
  }
}

TEST_F(LongTermTest, TellsTheLastOfOneTime) {
  open();
  record({snapshot(1, int64_t{1}), snapshot(1, int64_t{2})});
  ASSERT_THAT(*ask("latest"), ElementsAre(1));
  record({snapshot(1, int64_t{3})});
  const auto newest = recall->query(*ltm::Query::parse(std::string(kEntity) + " @ all"));
  ASSERT_OK(newest);
  const auto& snapshots = newest->entities()[0]->snapshots;
  ASSERT_THAT(snapshots, SizeIs(1));
  EXPECT_EQ(snapshots[0].instances[0].data, idf::Data(int64_t{3})) << "not what was decoded before";
}

TEST_F(LongTermTest, NotesWhatWasReadFromIt) {
  open();
  record({snapshot(1, int64_t{1}), snapshot(2, int64_t{2}), snapshot(3, int64_t{3})});
  ASSERT_THAT(*ask("all", {snapshot(3, int64_t{3})}), ElementsAre(1, 2, 3));
  ASSERT_THAT(*ask("1"), ElementsAre(1));
  recall.reset();
  ASSERT_OK(store->close());
  store.reset();
  const ltm::AccessTable reads = ltm::read_accesses(options.store);
  const auto count = [&](int64_t at) {
    return reads.find(*ltm::MemoryId::parse(kEntity), time_from_ns(at)).count;
  };
  EXPECT_EQ(count(1), 2u);
  EXPECT_EQ(count(2), 1u);
  EXPECT_EQ(count(3), 0u) << "it was read from memory";
}

TEST_F(LongTermTest, DecodesOnce) {
  open();
  record({snapshot(1, int64_t{1}), snapshot(2, int64_t{2})});
  ASSERT_THAT(*ask("all"), SizeIs(2));
  ASSERT_THAT(*ask("all"), SizeIs(2));
  EXPECT_EQ(reading->counters().decoded, 2u);
  EXPECT_EQ(reading->counters().from_decoded, 2u);
}

TEST_F(LongTermTest, RefusesWhatIsNotOfItsTypeAndStoresTheRest) {
  open();
  ASSERT_OK(store->declare(*ltm::MemoryId::parse("T/b"), idf::Type::int64()));
  const auto refused =
      record({snapshot(1, int64_t{1}), snapshot(1, std::string("a text"), "T/b/c/d"),
              snapshot(2, int64_t{2}), snapshot(3, int64_t{5}, "T/b/c/d")});
  ASSERT_THAT(refused, SizeIs(1));
  EXPECT_EQ(refused[0].snapshot->id().entity().to_string(), "T/b/c/d");
  EXPECT_EQ(refused[0].status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(*ask("all"), ElementsAre(1, 2));
  EXPECT_EQ(store->counters().recorded, 3u);
  EXPECT_EQ(store->counters().refused, 1u);
}

TEST_F(LongTermTest, RefusesAnswersThatAreTooLarge) {
  options.max_answer_bytes = 50'000;
  open();
  for (int64_t at = 1; at <= 10; ++at) record({snapshot(at, std::string(10'000, 'x'))});
  EXPECT_THAT(*ask("latest:4"), SizeIs(4));
  const auto all = ask("all");
  EXPECT_EQ(all.status().code(), StatusCode::kResourceExhausted);
  EXPECT_THAT(all.status().message(), HasSubstr("50000 bytes"));
}

/// A grey image with a bright stripe.
ltm::SharedSnapshot image_at(int64_t at) {
  std::vector<uint8_t> pixels(size_t{32} * 32, 50);
  for (int64_t y = 0; y < 32; ++y) pixels[static_cast<size_t>(y * 32 + at % 32)] = 200;
  return ltm::hold_untyped({*ltm::MemoryId::parse(kEntity),
                            time_from_ns(at * 200'000'000),
                            {{idf::NdArray::take({32, 32}, std::move(pixels)), {}}}});
}

TEST_F(LongTermTest, CodesImagesThatItSealsOnceThereIsASpace) {
  open();
  const auto codes_of_last = [this]() -> size_t {
    const auto manifest = ltm::read_manifest(options.store);
    const auto bytes =
        ltm::read_segment_index(options.store, manifest->segments.back(), ltm::kCodesIndex);
    return bytes.ok() ? ltm::unpack_codes(bytes->bytes())->front().times.size() : 0;
  };
  for (int64_t i = 0; i < 30; ++i) record({image_at(i)});
  ASSERT_OK(store->seal());
  ASSERT_OK(ltm::make_codes(options.store, {}, {}, {}, {}));
  for (int64_t i = 30; i < 50; ++i) record({image_at(i)});
  ASSERT_OK(store->seal());
  for (int tries = 0; tries < 2000 && codes_of_last() == 0; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(codes_of_last(), 20u);
}

TEST_F(LongTermTest, TakesNothingAfterTheEnd) {
  open();
  record({snapshot(1, int64_t{1})});
  ASSERT_OK(store->close());
  ASSERT_OK(store->close());
  std::vector<LongTerm::Refused> refused;
  const std::vector<ltm::SharedSnapshot> more = {snapshot(2, int64_t{2})};
  EXPECT_EQ(store->record(more, refused).code(), StatusCode::kFailedPrecondition);
  EXPECT_THAT(*ask("all"), ElementsAre(1));
  store.reset();
  open();
  EXPECT_THAT(*ask("all"), ElementsAre(1));
  EXPECT_THAT(refused, IsEmpty());
}

}  // namespace
}  // namespace engram::memory
