// SPDX-License-Identifier: Apache-2.0
#include "memory/live/memory_service.h"

#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "ltm/recording/recording_config.h"
#include "tests/memory/live/served_memory.h"

namespace engram::memory {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ServedMemory;
using ::testing::SizeIs;

constexpr const char* kEntity = "A/b/c/d";

TEST(MemoryService, AnswersFromMemoryAndStoreAsIfTheyWereOne) {
  ServedMemory service;
  service.options.memory.all.snapshots = 2;
  service.open();
  for (int64_t at = 1; at <= 9; ++at) {
    ASSERT_OK(service->commit(ServedMemory::commit(kEntity, at)));
    ASSERT_THAT(*service.ask("A @ all"), SizeIs(static_cast<size_t>(at)));
  }
  EXPECT_THAT(*service.ask("A/b/c/d @ 0..1, -2..-1"), ElementsAre(1, 2, 8, 9));
}

TEST(MemoryService, CountsAReadOnceWhereverTheAnswerComesFrom) {
  ServedMemory memory;
  memory.open();
  ASSERT_OK(memory->commit(ServedMemory::commit("A/b/c/d", 1)));
  ASSERT_OK(memory.ask("A/b/c/d @ latest"));  // Working memory alone can tell.
  EXPECT_EQ(memory->counters().memory.reads, 1u);
  ASSERT_OK(memory.ask("A/b/c/d @ latest, +1s"));  // It cannot predict.
  EXPECT_EQ(memory->counters().memory.reads, 2u);
  ASSERT_OK(memory.ask("?ids A/b/c/d @ latest"));
  EXPECT_EQ(memory->counters().memory.reads, 2u);
}

TEST(MemoryService, AnswersWithWhatAFilterReleasesForAnotherEntity) {
  ServedMemory service;
  auto recording = ltm::parse_recording_config(
      "entities: [{match: A, filters: [{trigger: {events: [{entity: X/.*/.*/.*}], before: 1s}}]}]",
      "filters");
  ASSERT_OK(recording);
  recording->store = service.options.store->recording.store;
  service.options.store->recording = *std::move(recording);
  service.options.memory.all.snapshots = 1;
  service.open();
  for (int64_t at = 1; at <= 3; ++at)
    ASSERT_OK(service.commit_durably(ServedMemory::commit(kEntity, at)));
  // The filter holds all, so the store is opened without them.
  ASSERT_THAT(*service.ask("A @ all"), ElementsAre(3));
  ASSERT_OK(service.commit_durably(ServedMemory::commit("X/b/c/door", 4)));
  EXPECT_THAT(*service.ask("A @ all"), ElementsAre(1, 2, 3));
}

TEST(MemoryService, KeepsEverythingOverAnEnd) {
  ServedMemory service;
  service.open();
  for (int64_t at = 1; at <= 5; ++at) ASSERT_OK(service->commit(ServedMemory::commit(kEntity, at)));
  ASSERT_OK(service->close());
  EXPECT_EQ(service->commit(ServedMemory::commit(kEntity, 6)).status().code(),
            StatusCode::kUnavailable);
  service.close();
  service.open();
  EXPECT_THAT(*service.ask("A @ all"), ElementsAre(1, 2, 3, 4, 5));
}

TEST(MemoryService, SaysWhatTheStoreWillNeverTake) {
  ServedMemory service;
  service.options.store_interval = std::chrono::hours(1);
  service.open();
  // Came before its type was known.
  const auto early = service->commit(ServedMemory::commit("T/b/c/d", 1, std::string("a text")), {},
                                     MemoryService::Durability::kJournal);
  ASSERT_OK(early);
  ASSERT_OK(service->declare(*ltm::MemoryId::parse("T/b"), idf::Type::int64()));
  const Status refused = service->wait_stored(*early);
  EXPECT_EQ(refused.code(), StatusCode::kInvalidArgument) << refused.to_string();
  EXPECT_EQ(service->wait_stored(*early).code(), StatusCode::kInvalidArgument) << "asked again";
  EXPECT_OK(service.commit_durably(ServedMemory::commit(kEntity, 2)));  // Not held up by another.
  EXPECT_OK(service.commit_durably(ServedMemory::commit("T/b/c/d", 2, int64_t{1})));
  EXPECT_EQ(service->counters().store->refused, 1u);
  EXPECT_EQ(service->counters().memory.waiting, 0u);
}

TEST(MemoryService, TellsThoseWhoAskAfterTheEnd) {
  ServedMemory service;
  service.options.store_interval = std::chrono::hours(1);
  service.open();
  const auto admission =
      service->commit(ServedMemory::commit(kEntity, 1), {}, MemoryService::Durability::kJournal);
  ASSERT_OK(admission);
  ASSERT_OK(service->close());
  EXPECT_OK(service->wait_stored(*admission));
  ltm::Admission later = *admission;
  later.queued += 1;
  EXPECT_EQ(service->wait_stored(later).code(), StatusCode::kUnavailable);
}

TEST(MemoryService, RefusesAnswersThatAreTooLarge) {
  ServedMemory service;
  service.options.memory.all.snapshots = 1;
  service.options.store->max_answer_bytes = 30'000;
  service.open();
  for (int64_t at = 1; at <= 8; ++at)
    for (const char* entity : {"A/b/c/d", "A/b/c/e"})
      ASSERT_OK(service.commit_durably(ServedMemory::commit(entity, at, std::string(4000, 'x'))));
  EXPECT_THAT(*service.ask("A/b/c/d @ latest:7"), SizeIs(7));
  EXPECT_EQ(service.ask("A @ all").status().code(), StatusCode::kResourceExhausted)
      << "entities together";
  EXPECT_THAT(*service.ask("?ids A @ all"), SizeIs(16));
}

TEST(MemoryService, KnowsSoManyEntities) {
  ServedMemory service;
  service.options.max_entities = 5;
  service.options.memory.all.snapshots = 1;
  service.open();
  // The one in working memory counts once, although the store has it, too.
  for (const char* entity : {"A/b/c/1", "A/b/c/2", "A/b/c/3", "A/b/c/4", "A/b/c/5"})
    ASSERT_OK(service.commit_durably(ServedMemory::commit(entity, 1)));
  const Status refused = service->commit(ServedMemory::commit("A/b/c/new", 1)).status();
  EXPECT_EQ(refused.code(), StatusCode::kResourceExhausted) << refused.to_string();
  EXPECT_THAT(refused.message(), HasSubstr("'A/b/c/new' would be a new entity"));
  EXPECT_THAT(refused.message(), HasSubstr("has 5 already, of at most 5"));
  // A known one goes on.
  EXPECT_OK(service.commit_durably(ServedMemory::commit("A/b/c/2", 2)));
}

TEST(MemoryService, SaysWhatItDoesNotHave) {
  ServedMemory service;
  service.options.memories = {"A", "B"};
  service.open();
  const Status foreign = service->commit(ServedMemory::commit("C/b/c/d", 1)).status();
  EXPECT_EQ(foreign.code(), StatusCode::kNotFound);
  EXPECT_THAT(foreign.message(), HasSubstr("A, B"));
  EXPECT_EQ(service.ask("A/x/y/z").status().code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace engram::memory
