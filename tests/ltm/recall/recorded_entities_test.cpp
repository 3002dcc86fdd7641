// SPDX-License-Identifier: Apache-2.0
// What a live store has of each entity, whether its name was read when the store was opened or not.
#include "ltm/recall/recorded_entities.h"

#include <gmock/gmock.h>

#include "tests/ltm/random_values.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

MemoryId thing(int64_t i) {
  return *MemoryId::parse(fmt::format("Objects/Things/room/thing{:03}", i));
}

SharedSnapshot held(int64_t i, int64_t at) {
  return hold_untyped({thing(i), example_time(at), {{idf::Data(int64_t{at}), {}}}});
}

std::vector<SegmentInfo> segments_of(int64_t count) {
  std::vector<SegmentInfo> segments(2);
  for (int64_t i = 0; i < count; ++i)
    for (size_t segment = 0; segment < 2; ++segment)
      if (segment == 0 || i % 3 == 0)
        segments[segment].entities.edit().push_back(
            {thing(i),
             1,
             1,
             example_time(i),
             example_time(i + static_cast<int64_t>(segment)),
             0,
             0,
             0,
             0,
             {}});
  return segments;
}

TEST(RecordedEntities, KnowsWhatTheStoreHadWhenItWasOpened) {
  RecordedEntities recorded;
  recorded.begin_with(EntityIndex(segments_of(6)),
                      {{thing(2), example_time(50)}, {thing(8), example_time(7)}});
  EXPECT_EQ(recorded.max_size(), 9U) << "two are named twice, one is in a journal alone";
  EXPECT_EQ(recorded.known_until(thing(1)), example_time(1));
  EXPECT_EQ(recorded.known_until(thing(2)), example_time(50));
  EXPECT_EQ(recorded.known_until(thing(3)), example_time(4));
  EXPECT_EQ(recorded.known_until(thing(7)), std::nullopt);
  EXPECT_TRUE(recorded.contains(thing(8)));
  EXPECT_FALSE(recorded.contains(thing(9)));
  EXPECT_THAT(recorded.matching(*Query::parse("Objects/Things/room/thing002 @ latest")),
              ElementsAre(thing(2)));
  EXPECT_THAT(recorded.matching(*Query::parse("Objects @ latest")),
              ElementsAre(thing(0), thing(1), thing(2), thing(3), thing(4), thing(5), thing(8)));
  EXPECT_EQ(recorded.size(), 7U);
  EXPECT_EQ(recorded.max_size(), 7U);
}

TEST(RecordedEntities, ForgetsAndRecordsAgain) {
  RecordedEntities recorded;
  recorded.begin_with(EntityIndex(segments_of(3)), {});
  recorded.correct(thing(1), std::nullopt);
  recorded.correct(thing(7), std::nullopt);
  EXPECT_FALSE(recorded.contains(thing(1)));
  EXPECT_EQ(recorded.known_until(thing(1)), std::nullopt);
  const SharedSnapshot again = held(1, 20);
  recorded.begin({&again, 1});
  recorded.finish({&again, 1}, {});
  EXPECT_EQ(recorded.known_until(thing(1)), example_time(20));
  recorded.correct(thing(1), std::nullopt);
  EXPECT_THAT(recorded.matching(*Query::parse("Objects @ latest")),
              ElementsAre(thing(0), thing(2)));
  recorded.correct(thing(0), std::nullopt);
  recorded.correct(thing(2), std::nullopt);
  EXPECT_THAT(recorded.matching(*Query::parse("Objects @ latest")), IsEmpty());
  EXPECT_EQ(recorded.size(), 0U);
}

/// Whether and when names are read must not show in what is told.
TEST(RecordedEntities, TellsTheSameWhenAllNamesWereRead) {
  RandomValues random(11);
  for (int round = 0; round < 50; ++round) {
    RecordedEntities lazy, all;
    lazy.begin_with(EntityIndex(segments_of(12)), {{thing(20), example_time(1)}});
    all.begin_with(EntityIndex(segments_of(12)), {{thing(20), example_time(1)}});
    EXPECT_EQ(all.size(), 13U);
    for (int step = 0; step < 40; ++step) {
      const auto i = static_cast<int64_t>(random.below(24));
      const auto at = static_cast<int64_t>(random.below(60));
      const SharedSnapshot snapshot = held(i, at);
      const uint64_t what = random.below(4);
      for (RecordedEntities* each : {&lazy, &all}) {
        if (what == 0) each->correct(thing(i), std::nullopt);
        if (what == 1) each->correct(thing(i), example_time(at));
        if (what == 2) {
          each->begin({&snapshot, 1});
          each->finish({&snapshot, 1}, {});
        }
      }
      ASSERT_EQ(lazy.known_until(thing(i)), all.known_until(thing(i)));
      ASSERT_EQ(lazy.contains(thing(i)), all.contains(thing(i)));
      ASSERT_EQ(lazy.recorded_at(thing(i)), all.recorded_at(thing(i)));
      ASSERT_GE(lazy.max_size(), all.size());
    }
    EXPECT_EQ(lazy.matching(Query()), all.matching(Query()));
    EXPECT_EQ(lazy.size(), all.size());
  }
}

}  // namespace
}  // namespace engram::ltm
