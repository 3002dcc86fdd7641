// SPDX-License-Identifier: Apache-2.0
// Queries while snapshots leave working memory for the store: never wrong, whoever is faster.
#include <gmock/gmock.h>

#include <atomic>
#include <random>
#include <thread>

#include "ltm/store/store_reader.h"
#include "tests/memory/live/served_memory.h"

namespace engram::memory {
namespace {

using testing::ServedMemory;

/// One entity, whose snapshots come at 10, 20, 30, ... in this order, with their time as value.
struct Stream {
  std::string entity;
  std::atomic<int64_t> begun{0};      ///< The newest that may be there.
  std::atomic<int64_t> committed{0};  ///< The newest that is there.

  void write(ServedMemory& service, int64_t count) {
    for (int64_t i = 1; i <= count; ++i) {
      begun = i;
      ASSERT_OK(service->commit(ServedMemory::commit(entity, i * 10, i * 10)));
      committed = i;
      // Not faster than the store: what is asked for is always on its way.
      while (service->counters().memory.waiting > 20)
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }
};

/// The values of an answer are those of its times; returns the times.
Result<std::vector<int64_t>> checked(const ltm::Answer& answer) {
  std::vector<int64_t> times;
  for (const ltm::RecalledEntity& entity : answer.entities)
    for (const ltm::RecalledSnapshot& one : entity.snapshots) {
      times.push_back(to_ns(one.answer.time));
      if (one.answer.instances.size() != 1 ||
          one.answer.instances[0].data != idf::Data(times.back()))
        return data_loss("at {}: another value", times.back());
    }
  return times;
}

Result<std::vector<int64_t>> ask(ServedMemory& service, const std::string& query) {
  ENGRAM_ASSIGN_OR_RETURN(const auto answer, service->query(*ltm::Query::parse(query)));
  return checked(answer);
}

/// 10 * first, ..., 10 * last.
std::vector<int64_t> steps(int64_t first, int64_t last) {
  std::vector<int64_t> all;
  for (int64_t i = first; i <= last; ++i) all.push_back(i * 10);
  return all;
}

void expect_all(ServedMemory& service, const Stream& stream) {
  const int64_t before = stream.committed;
  const auto times = ask(service, stream.entity + " @ all");
  const int64_t after = stream.begun;
  if (before == 0 && times.status().code() == StatusCode::kNotFound) return;
  ASSERT_OK(times);
  const auto count = static_cast<int64_t>(times->size());
  ASSERT_TRUE(count >= before && count <= after) << count << " of " << before << " to " << after;
  ASSERT_EQ(*times, steps(1, count));
}

void expect_latest(ServedMemory& service, const Stream& stream, int64_t max) {
  const int64_t before = stream.committed;
  if (before < max) return;
  const auto times = ask(service, fmt::format("{} @ latest:{}", stream.entity, max));
  ASSERT_OK(times);
  const int64_t last = times->back() / 10;
  ASSERT_GE(last, before);
  ASSERT_EQ(*times, steps(last - max + 1, last));
}

void expect_one(ServedMemory& service, const Stream& stream, uint32_t number) {
  const int64_t before = stream.committed;
  if (before == 0) return;
  const int64_t index = 1 + number % before;
  const auto at = ask(service, fmt::format("{} @ at-or-before:{}", stream.entity, index * 10 + 4));
  ASSERT_OK(at);
  ASSERT_EQ(*at, steps(index, index));
  const auto nth = ask(service, fmt::format("{} @ {}..{}", stream.entity, index - 1, index - 1));
  ASSERT_OK(nth);
  ASSERT_EQ(*nth, steps(index, index));
}

TEST(ParallelService, AnswersRightlyWhileSnapshotsLeave) {
  ServedMemory service;
  service.options.memory.all.snapshots = 6;
  service.options.store_interval = std::chrono::milliseconds(1);
  // Sealed again and again meanwhile.
  service.options.store->recording.store.seal_bytes = 16 << 10;
  service.options.store->max_decoded_bytes = 4 << 10;
  service.open();
  constexpr int64_t kCount = 250;
  std::array<Stream, 2> streams;
  for (size_t i = 0; i < streams.size(); ++i) streams[i].entity = fmt::format("A/b/c/d{}", i);
  std::atomic<int> writing{static_cast<int>(streams.size())};
  {
    std::vector<std::jthread> threads;
    for (Stream& stream : streams)
      threads.emplace_back([&] {
        stream.write(service, kCount);
        --writing;
      });
    for (unsigned reader = 0; reader < 3; ++reader)
      threads.emplace_back([&, reader] {
        std::mt19937 random(reader);
        while (writing > 0 && !::testing::Test::HasFailure()) {
          const Stream& stream = streams[random() % streams.size()];
          switch (random() % 3) {
            case 0:
              expect_all(service, stream);
              break;
            case 1:
              expect_latest(service, stream, 1 + random() % 12);
              break;
            default:
              expect_one(service, stream, random());
              break;
          }
        }
      });
  }
  // On a busy machine nothing may have left until here.
  for (int i = 0; i < 1000 && service->counters().memory.left == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  for (const Stream& stream : streams) expect_all(service, stream);
  const auto counters = service->counters();
  EXPECT_EQ(counters.memory.committed, streams.size() * kCount);
  EXPECT_GT(counters.memory.left, 0u);
  EXPECT_GT(counters.queries_of_store, 0u);
  ASSERT_OK(service->close());
}

TEST(ParallelService, StoresWhatItAcknowledgesAsDurable) {
  ServedMemory service;
  service.options.memory.all.snapshots = 20;
  service.open();
  constexpr int kThreads = 4;
  constexpr int64_t kEach = 50;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < kThreads; ++t)
      threads.emplace_back([&service, t] {
        for (int64_t i = 1; i <= kEach; ++i)
          ASSERT_OK(service.commit_durably(
              ServedMemory::commit(fmt::format("A/b/c/d{}", t), i * 10, i * 10)));
      });
  }
  const auto store = ltm::StoreReader::open(service.options.store->store);
  ASSERT_OK(store);
  for (int t = 0; t < kThreads; ++t) {
    const auto timeline = (*store)->timeline(*ltm::MemoryId::parse(fmt::format("A/b/c/d{}", t)));
    ASSERT_OK(timeline);
    EXPECT_EQ(*(*timeline)->count(), static_cast<uint64_t>(kEach));
  }
}

}  // namespace
}  // namespace engram::memory
