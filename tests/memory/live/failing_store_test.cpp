// SPDX-License-Identifier: Apache-2.0
// A store whose disk fails: nothing that was acknowledged as durable is lost, errors are told, and
// what waits is tried again.
#include <gmock/gmock.h>

#include <set>

#include "ltm/store/store_reader.h"
#include "tests/faults/faulty_files.h"
#include "tests/memory/live/served_memory.h"

namespace engram::memory {
namespace {

using testing::ServedMemory;

constexpr const char* kEntity = "A/b/c/d";

/// Times of the entity that a store has.
std::set<int64_t> stored(const std::filesystem::path& path) {
  std::set<int64_t> times;
  const auto store = ltm::StoreReader::open(path);
  EXPECT_OK(store);
  const auto timeline = (*store)->timeline(*ltm::MemoryId::parse(kEntity));
  if (!timeline.ok()) return times;
  for (auto next = (*timeline)->at_or_after(time_from_ns(0)); next.ok() && next->has_value();
       next = (*timeline)->at_or_after((*next)->time + Duration(1)))
    times.insert(to_ns((*next)->time));
  return times;
}

class FailingStore : public ::testing::TestWithParam<int> {};

TEST_P(FailingStore, LosesNothingThatItAcknowledged) {
  for (int64_t call = 1; call < 60; call += 3) {
    ServedMemory service;
    service.options.memory.all.snapshots = 3;
    faulty_files_watch(service.folder.path().c_str());
    service.open();
    ASSERT_OK(service.commit_durably(ServedMemory::commit(kEntity, 1)));
    faulty_files_fail(faulty_files_calls() + call, GetParam());
    std::set<int64_t> acknowledged = {1};
    std::set<int64_t> taken = {1};
    for (int64_t at = 2; at <= 20; ++at) {
      const auto admission = service->commit(ServedMemory::commit(kEntity, at), {},
                                             MemoryService::Durability::kJournal);
      if (!admission.ok()) continue;
      taken.insert(at);
      if (service->wait_stored(*admission).ok()) acknowledged.insert(at);
    }
    EXPECT_TRUE(std::ranges::includes(stored(service.options.store->store), acknowledged));
    // Whatever was taken can be read, stored or not.
    const auto all = service.ask("A @ all");
    ASSERT_OK(all);
    EXPECT_EQ(std::set<int64_t>(all->begin(), all->end()), taken);
    if (acknowledged.size() < taken.size()) {
      EXPECT_GT(service->counters().store_failures, 0u);
    }
    // The disk is well again: what waits is tried again, and is durable then.
    faulty_files_fail(0, kFaultNone);
    const Status again = service.commit_durably(ServedMemory::commit(kEntity, 99));
    const Status closed = service->close();
    if (!again.ok()) continue;  // A journal that failed to be forced says so until the end.
    EXPECT_OK(closed);
    taken.insert(99);
    EXPECT_EQ(stored(service.options.store->store), taken) << "call " << call;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, FailingStore,
                         ::testing::Values(kFaultShort, kFaultNoSpace, kFaultBroken, kFaultFull,
                                           kFaultDead));

TEST(FailingFilters, StoresWhatFiltersKeepWhenItIsTriedAgain) {
  ServedMemory service;
  service.options.store->recording.max_rate_hz = 1000.0;
  service.options.store_interval = std::chrono::milliseconds(2);
  faulty_files_watch(service.folder.path().c_str());
  service.open();
  ASSERT_OK(service.commit_durably(ServedMemory::commit(kEntity, 1)));
  faulty_files_fail(faulty_files_calls() + 1, kFaultFull);
  constexpr int64_t kSecond = 1'000'000'000;
  for (int64_t i = 1; i <= 5; ++i) {
    const Status refused = service.commit_durably(ServedMemory::commit(kEntity, i * kSecond));
    EXPECT_FALSE(refused.ok());
  }
  faulty_files_fail(0, kFaultNone);
  ASSERT_OK(service.commit_durably(ServedMemory::commit(kEntity, 6 * kSecond)));
  EXPECT_EQ(stored(service.options.store->store).size(), 7u);
}

}  // namespace
}  // namespace engram::memory
