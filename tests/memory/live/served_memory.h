// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "memory/live/memory_service.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::testing {

/// A memory service with a store in a folder of its own.
class ServedMemory {
 public:
  ServedMemory() {
    options.name = "test";
    options.store.emplace();
    options.store->store = folder / "store.engram";
    options.store->recording.store.min_free_bytes = 0;
    options.store->recording.store.durability = ltm::Durability::kNone;
    options.store_interval = std::chrono::milliseconds(5);
  }

  void open() {
    auto opened = memory::MemoryService::open(options, nullptr);
    ASSERT_OK(opened);
    service_ = *std::move(opened);
  }
  void close() { service_.reset(); }

  memory::MemoryService* operator->() { return service_.get(); }

  static ltm::Commit commit(const std::string& entity, int64_t at, idf::Data data = int64_t{7}) {
    return {{{*ltm::MemoryId::parse(entity), time_from_ns(at), {{std::move(data), {}}}}}};
  }

  /// Commits, and waits until the store has it.
  Status commit_durably(const ltm::Commit& commit) {
    ENGRAM_ASSIGN_OR_RETURN(
        const auto admission,
        service_->commit(commit, {}, memory::MemoryService::Durability::kJournal));
    return service_->wait_stored(admission);
  }

  /// Times of what it answers.
  Result<std::vector<int64_t>> ask(const std::string& query) {
    ENGRAM_ASSIGN_OR_RETURN(const auto answer, service_->query(*ltm::Query::parse(query)));
    std::vector<int64_t> times;
    for (const ltm::RecalledEntity& entity : answer.entities)
      for (const ltm::RecalledSnapshot& snapshot : entity.snapshots)
        times.push_back(to_ns(snapshot.answer.time));
    return times;
  }

  ScratchDirectory folder;
  memory::MemoryService::Options options;

 private:
  std::unique_ptr<memory::MemoryService> service_;
};

}  // namespace engram::testing
