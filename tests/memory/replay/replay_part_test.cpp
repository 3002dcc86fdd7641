// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_part.h"

#include <gtest/gtest.h>

#include "ltm/store/rewrite.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::memory {
namespace {

using ltm::example_entity;
using ltm::example_time;

/// A store of many segments, so that a reader cannot keep all of them open.
class ReplayPartTest : public ::testing::Test {
 protected:
  ReplayPartTest() {
    EXPECT_OK(ltm::create_store(path_));
    const auto writer = *ltm::StoreWriter::open(path_, {});
    const auto append = [&](const std::string& name, int64_t time) {
      const ltm::MemoryId id = example_entity(name);
      const Time at = example_time(time);
      const ltm::Snapshot one{id, at, {{idf::Dict{{"x", 1.0}}, {at, at, at, "t", 1}}}};
      EXPECT_OK(writer->append({ltm::pack_snapshot(one)}, nullptr));
    };
    append("a", 1);
    append("b", 2);
    append("c", 3);
    EXPECT_OK(writer->seal());
    append("a", 1000);
    EXPECT_OK(writer->seal());
    for (int i = 0; i < 100; ++i) {
      append("other" + std::to_string(i), 2000 + i);
      EXPECT_OK(writer->seal());
    }
  }

  const ScratchDirectory scratch_;
  const std::filesystem::path path_ = scratch_ / "store";
};

TEST_F(ReplayPartTest, TellsFromTheNewestStoreIfItWasRewritten) {
  const auto part = ReplayPart::open(path_, nullptr, [] { return Time::max(); });
  ASSERT_OK(part);
  const auto above =
      *ltm::WorkingMemory::create({.mode = ltm::StoreMode::kLatest}, [] { return Time::max(); });
  const auto past = (*part)->attach("replay", *above);
  std::vector<ltm::MemoryId> told;
  (*part)->tell({.is_wanted = [](const ltm::MemoryId&) { return true; },
                 .publish =
                     [&told](std::span<const ltm::SharedSnapshot> snapshots) {
                       for (const auto& one : snapshots) told.push_back(one->id());
                     }});
  (*part)->restart(example_time(0));
  ASSERT_OK((*part)->prepare(SIZE_MAX));
  ASSERT_OK(ltm::forget_snapshots(path_, {{example_entity("b"), TimeSet{example_time(2)}}}));
  ReplayPart::Passed passed;
  for (int i = 0; i < 3; ++i) {
    for (;;) {
      const auto is_prepared = (*part)->prepare(SIZE_MAX);
      ASSERT_OK(is_prepared);
      if (*is_prepared) break;
    }
    const ReplayPart::Passed one = (*part)->pass();
    passed.snapshots += one.snapshots;
    passed.unreadable += one.unreadable;
  }
  EXPECT_EQ(passed.unreadable, 0u);
  EXPECT_EQ(told, (std::vector{example_entity("a").at(example_time(1)),
                               example_entity("c").at(example_time(3)),
                               example_entity("a").at(example_time(1000))}));
  (*part)->detach();
}

}  // namespace
}  // namespace engram::memory
