// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/arrival_order.h"

#include <gtest/gtest.h>

#include <random>

#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::memory {
namespace {

using ltm::example_entity;

/// Some entities arrived late, some at their own times, several at once.
TEST(ArrivalOrder, IsThatOfArrivalsAndThenOfIds) {
  const ScratchDirectory scratch;
  const auto path = scratch / "store";
  ASSERT_OK(ltm::create_store(path));
  std::vector<std::pair<Time, ltm::MemoryId>> expected;
  std::mt19937 random(2);
  {
    const auto writer = *ltm::StoreWriter::open(path, {});
    for (int64_t i = 0; i < 60; ++i)
      for (int entity = 0; entity < 3; ++entity) {
        const Time time = ltm::example_time(i);
        const Time arrived =
            entity == 2 ? time : time + std::chrono::milliseconds(200 * (random() % 5));
        const ltm::MemoryId id = example_entity("cam" + std::to_string(entity));
        const ltm::Snapshot one{id, time, {{idf::Dict{{"x", 1.0}}, {time, time, arrived, "t", 1}}}};
        ASSERT_OK(writer->append({ltm::pack_snapshot(one)}, nullptr));
        expected.emplace_back(arrived, id.at(time));
        if (i == 20) ASSERT_OK(writer->seal());
      }
    ASSERT_OK(writer->seal());
  }
  std::ranges::sort(expected);
  const auto past = *ltm::ReplayedPast::open(path, nullptr, [] { return Time::max(); });
  ArrivalOrder order(*past);
  for (const int64_t from : {-1, 0, 7, 30, 59, 3, 100}) {
    const Time start = ltm::example_time(from);
    order.restart(start);
    while (!*order.prepare(1)) {
    }
    std::vector<std::pair<Time, ltm::MemoryId>> found, after;
    for (const auto& one : expected)
      if (one.first > start) after.push_back(one);
    while (const auto next = order.next()) {
      const auto taken = order.take();
      ASSERT_OK(taken);
      for (const ltm::MemoryId& id : *taken) found.emplace_back(*next, id);
    }
    EXPECT_EQ(found, after) << from;
  }
}

}  // namespace
}  // namespace engram::memory
