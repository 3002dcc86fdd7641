// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "ltm/working/working_memory.h"

namespace engram::testing {

/// A working memory with a clock of its own, and what its sink was given.
class PlainMemory {
 public:
  explicit PlainMemory(const ltm::WorkingMemory::Options& options)
      : memory_(std::move(*ltm::WorkingMemory::create(options, [this] { return now; }))) {}

  ltm::WorkingMemory* operator->() { return memory_.get(); }
  ltm::WorkingMemory& operator*() { return *memory_; }

  static ltm::Snapshot snapshot(const std::string& entity, int64_t at, idf::Data data) {
    return {*ltm::MemoryId::parse(entity), time_from_ns(at), {{std::move(data), {}}}};
  }

  void commit(const std::string& entity, int64_t at, idf::Data data = int64_t{0}) {
    const Status status = memory_->commit({{snapshot(entity, at, std::move(data))}});
    ASSERT_TRUE(status.ok()) << status.to_string();
  }

  /// How many were stored.
  size_t store(size_t max_bytes = SIZE_MAX) {
    const auto count = memory_->store(
        [this](std::span<const ltm::SharedSnapshot> snapshots) {
          for (const auto& one : snapshots) stored.push_back(one->id().to_string());
          return Status();
        },
        max_bytes);
    EXPECT_TRUE(count.ok()) << count.status().to_string();
    return count.value_or(0);
  }

  /// IDs of what it answers.
  std::vector<std::string> ask(const std::string& query) {
    std::vector<std::string> ids;
    for (const ltm::MemoryId& id : memory_->query(*ltm::Query::parse(query)).ids())
      ids.push_back(id.to_string());
    return ids;
  }

  /// Times of the entity's snapshots.
  std::vector<int64_t> times(const std::string& entity) {
    std::vector<int64_t> all;
    for (const auto& one : memory_->select(*ltm::Query::parse(entity + " @ all")))
      for (const auto& found : one.snapshots) all.push_back(to_ns(found->time));
    return all;
  }

  Time now = time_from_ns(1'000'000'000'000);
  std::vector<std::string> stored;

 private:
  std::unique_ptr<ltm::WorkingMemory> memory_;
};

}  // namespace engram::testing
