// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/entity_times.h"

#include <limits>
#include <map>

#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

std::vector<Time> times_of(std::initializer_list<int64_t> ns) {
  std::vector<Time> times;
  for (const int64_t one : ns) times.push_back(time_from_ns(one));
  return times;
}

TimeBins bins_of(int64_t first, int64_t last, size_t count) {
  return *TimeBins::create(time_from_ns(first), time_from_ns(last), count);
}

TEST(TimeBins, CoverTheirSpanWithoutGaps) {
  const TimeBins bins = bins_of(0, 10, 3);
  EXPECT_EQ(to_ns(bins.begin(0)), 0);
  EXPECT_EQ(to_ns(bins.begin(1)), 3);
  EXPECT_EQ(to_ns(bins.begin(2)), 6);
  EXPECT_EQ(to_ns(bins.begin(3)), 10);
}

TEST(TimeBins, AreExactOverAllTimesThatThereAre) {
  constexpr int64_t kMin = std::numeric_limits<int64_t>::min();
  constexpr int64_t kMax = std::numeric_limits<int64_t>::max();
  const TimeBins bins = bins_of(kMin, kMax, TimeBins::kMaxCount);
  EXPECT_EQ(to_ns(bins.begin(0)), kMin);
  EXPECT_EQ(to_ns(bins.begin(TimeBins::kMaxCount)), kMax);
  for (size_t i = 0; i < TimeBins::kMaxCount; ++i) ASSERT_LT(bins.begin(i), bins.begin(i + 1));
}

TEST(TimeBins, RefuseSpansThatAreNone) {
  EXPECT_FAILS(TimeBins::create(time_from_ns(5), time_from_ns(5), 3), StatusCode::kInvalidArgument,
               "needs an end after its beginning");
  EXPECT_FAILS(TimeBins::create(time_from_ns(6), time_from_ns(5), 3), StatusCode::kInvalidArgument,
               "needs an end after its beginning");
  EXPECT_FAILS(TimeBins::create(time_from_ns(5), time_from_ns(6), 0), StatusCode::kInvalidArgument,
               "needs 1 to 65536");
  EXPECT_FAILS(TimeBins::create(time_from_ns(5), time_from_ns(6), TimeBins::kMaxCount + 1),
               StatusCode::kInvalidArgument, "needs 1 to 65536");
}

TEST(EntityTimes, CountEachSnapshotOnceInItsForm) {
  EntityTimes times;
  times.add(times_of({1, 2, 3, 11, 12}), false, false);
  times.add(times_of({2, 3}), true, false);
  times.add(times_of({13}), false, true);
  EXPECT_EQ(times.count_in(bins_of(0, 20, 2)), (std::vector<FormCounts>{{1, 2, 0}, {2, 0, 1}}));
  // The end of a span is no part of it.
  EXPECT_EQ(times.count_in(bins_of(1, 3, 1)), (std::vector<FormCounts>{{1, 1, 0}}));
  EXPECT_EQ(times.count_in(bins_of(100, 200, 1)), (std::vector<FormCounts>{{0, 0, 0}}));
}

TEST(EntityTimes, ForgetLatentsThatALaterRecordingSupersedes) {
  EntityTimes times;
  times.add(times_of({1, 2}), true, false);
  times.add(times_of({2}), false, false);
  EXPECT_EQ(times.count_in(bins_of(0, 10, 1)), (std::vector<FormCounts>{{1, 1, 0}}));
  times.add(times_of({2}), true, false);
  EXPECT_EQ(times.count_in(bins_of(0, 10, 1)), (std::vector<FormCounts>{{0, 2, 0}}));
}

TEST(EntityTimes, AreUnitedInAnyOrder) {
  RandomValues random(3);
  for (int round = 0; round < 50; ++round) {
    EntityTimes times;
    std::map<Time, int> known;  // 0: recorded, 1: latent, 2: augmented.
    for (int part = 0; part < 6; ++part) {
      const bool is_latent = random.below(3) == 0;
      const bool is_augmented = !is_latent && random.below(3) == 0;
      std::vector<Time> some;
      for (int64_t ns = 0; ns < 40; ++ns)
        if (random.below(4) == 0) some.push_back(time_from_ns(ns));
      times.add(some, is_latent, is_augmented);
      for (const Time time : some) known[time] = is_latent ? 1 : is_augmented ? 2 : 0;
    }
    FormCounts needed;
    for (const auto& [time, form] : known)
      ++(form == 1 ? needed.latent : form == 2 ? needed.augmented : needed.recorded);
    ASSERT_EQ(times.count_in(bins_of(0, 40, 1)), std::vector<FormCounts>{needed}) << round;
    ASSERT_EQ(times.all.size(), known.size());
  }
}

TEST(EntityTimes, OfAStoreAreThoseOfItsTimeline) {
  const ScratchDirectory scratch;
  EXPECT_OK(create_store(scratch / "store"));
  {
    const auto writer = *StoreWriter::open(scratch / "store", {});
    RandomValues random(7);
    for (int64_t write = 0; write < 90; ++write) {
      Snapshot snapshot{example_entity(),
                        time_from_ns(static_cast<int64_t>(random.below(60))),
                        {{idf::Dict{{"write", write}}, {}}, {idf::Dict{{"write", write}}, {}}}};
      EXPECT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
      if (write % 20 == 19) EXPECT_OK(writer->seal());
    }
  }
  const auto reader = *StoreReader::open(scratch / "store");
  const auto times = reader->times(example_entity());
  ASSERT_OK(times);
  std::vector<Time> needed;
  EXPECT_OK((*reader->timeline(example_entity()))->for_each([&needed](const SnapshotEntry& entry) {
    needed.push_back(entry.time);
    return Status();
  }));
  EXPECT_EQ(times->all, needed);
  EXPECT_TRUE(times->latent.empty());
  EXPECT_TRUE(times->augmented.empty());
  EXPECT_FAILS(reader->times(*MemoryId::parse("a/b/c/none")), StatusCode::kNotFound,
               "has no entity");
}

}  // namespace
}  // namespace engram::ltm
