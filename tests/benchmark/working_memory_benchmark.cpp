// SPDX-License-Identifier: Apache-2.0
// What working memory adds to a commit and to a look-up: one small object, full memories of
// different sizes. Two threads read at once in `LookUp/…/threads:2`.
#include <benchmark/benchmark.h>

#include <map>
#include <mutex>

#include "ltm/working/working_memory.h"

namespace engram::server {
namespace {

using ltm::MemoryId;

constexpr int64_t kStep = 1000;

MemoryId entity_of(int64_t entity) {
  return *MemoryId::parse("Robot/Object/pose/" + std::to_string(entity));
}

ltm::Commit commit_of(const MemoryId& entity, int64_t at) {
  return {{{entity, time_from_ns(at), {{idf::Dict{{"x", 0.5}, {"y", 1.5}, {"name", "cup"}}, {}}}}}};
}

/// A memory that has as many snapshots as it may have, of so many entities.
struct FullMemory {
  FullMemory(int64_t snapshots, int64_t entity_count) {
    ltm::WorkingMemory::Options options;
    options.all = {static_cast<size_t>(snapshots), {}, {}};
    options.mode = ltm::StoreMode::kLatest;  // What leaves is gone: no sink is measured.
    options.store_interval = std::chrono::hours(1);
    options.max_waiting_bytes = SIZE_MAX;
    memory = std::move(*ltm::WorkingMemory::create(options));
    for (int64_t i = 0; i < entity_count; ++i) entities.push_back(entity_of(i));
    for (int64_t i = 0; i < snapshots; ++i) add();
  }

  const MemoryId& next_entity() { return entities[static_cast<size_t>(count) % entities.size()]; }

  void add() {
    const MemoryId& entity = next_entity();
    const Status done = memory->commit(commit_of(entity, ++count * kStep));
    if (!done.ok()) std::abort();
  }

  std::unique_ptr<ltm::WorkingMemory> memory;
  std::vector<MemoryId> entities;
  int64_t count = 0;
};

/// Arguments: snapshots in memory, entities.
void Insert(benchmark::State& state) {
  FullMemory full(state.range(0), state.range(1));
  for (auto _ : state) {
    state.PauseTiming();
    ltm::Commit commit = commit_of(full.next_entity(), ++full.count * kStep);
    state.ResumeTiming();
    benchmark::DoNotOptimize(full.memory->commit(std::move(commit)));
  }
}
BENCHMARK(Insert)
    ->Args({1000, 1})
    ->Args({1000, 1000})
    ->Args({1'000'000, 1})
    ->Args({1'000'000, 1000});

FullMemory& shared_memory(int64_t snapshots, int64_t entities) {
  static std::map<std::pair<int64_t, int64_t>, std::unique_ptr<FullMemory>> all;
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  auto& full = all[{snapshots, entities}];
  if (!full) full = std::make_unique<FullMemory>(snapshots, entities);
  return *full;
}

/// Of any time, in any order.
void LookUp(benchmark::State& state) {
  FullMemory& full = shared_memory(state.range(0), state.range(1));
  std::vector<MemoryId> ids;
  uint64_t random = static_cast<uint64_t>(state.thread_index()) + 1;
  for (int i = 0; i < 4096; ++i) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    const auto nth = static_cast<int64_t>((random >> 20) % static_cast<uint64_t>(state.range(0)));
    ids.push_back(full.entities[static_cast<size_t>(nth % state.range(1))].at(
        time_from_ns((nth + 1) * kStep)));
  }
  size_t i = 0, found = 0;
  for (auto _ : state) found += full.memory->find(ids[i++ & 4095]) != nullptr ? 1 : 0;
  if (found != static_cast<size_t>(state.iterations())) state.SkipWithError("not found");
}
BENCHMARK(LookUp)
    ->Args({1000, 1})
    ->Args({1000, 1000})
    ->Args({1'000'000, 1})
    ->Args({1'000'000, 1000})
    ->Args({1'000'000, 1'000'000})
    ->UseRealTime()
    ->ThreadRange(1, 2);

/// The newest of one entity, by a query.
void QueryLatest(benchmark::State& state) {
  FullMemory& full = shared_memory(state.range(0), state.range(1));
  const auto query = *ltm::Query::parse("Robot/Object/pose/0");
  for (auto _ : state) benchmark::DoNotOptimize(full.memory->select(query));
}
BENCHMARK(QueryLatest)->Args({1000, 1000})->Args({1'000'000, 1000});

}  // namespace
}  // namespace engram::server
