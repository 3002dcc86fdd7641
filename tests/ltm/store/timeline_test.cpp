// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/timeline.h"

#include <map>
#include <ranges>

#include "ltm/store/publish.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

constexpr int64_t kTimes = 60;

/// What a store should hold: per time the number of the write that came last.
using Expected = std::map<Time, int64_t>;

Snapshot numbered(int64_t time, int64_t write, size_t instances) {
  Snapshot snapshot{example_entity(), time_from_ns(time * 10), {}};
  for (size_t i = 0; i < instances; ++i)
    snapshot.instances.push_back({idf::Dict{{"write", write}}, {}});
  return snapshot;
}

/// Times in any order, some again and again, sealed now and then.
Expected write_at_random(const std::filesystem::path& store, uint64_t seed) {
  RandomValues random(seed);
  const auto writer = *StoreWriter::open(store, {});
  const int64_t late = static_cast<int64_t>(random.below(static_cast<size_t>(kTimes)));
  Expected expected;
  for (int64_t write = 0; write < 80; ++write) {
    const int64_t time = std::clamp<int64_t>(
        write + static_cast<int64_t>(random.below(static_cast<size_t>(late) + 1)) - late / 2, 0,
        kTimes);
    const Snapshot snapshot = numbered(time, write, seed % 2 == 0 ? 1 : 1 + random.below(3));
    EXPECT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
    expected[snapshot.time] = write;
    if (random.below(12) == 0) EXPECT_OK(writer->seal());
  }
  return expected;
}

class TimelineTest : public ::testing::TestWithParam<uint64_t> {
 protected:
  void SetUp() override {
    EXPECT_OK(create_store(scratch_ / "store"));
    expected_ = write_at_random(scratch_ / "store", GetParam());
    reader_ = *StoreReader::open(scratch_ / "store");
    timeline_ = *reader_->timeline(example_entity());
  }

  void expect_entry(const Result<std::optional<SnapshotEntry>>& found,
                    Expected::const_iterator needed) {
    ASSERT_OK(found);
    ASSERT_EQ(found->has_value(), needed != expected_.end());
    if (!found->has_value()) return;
    EXPECT_EQ((*found)->time, needed->first);
    const auto snapshot = reader_->read_recorded(example_entity(), **found);
    ASSERT_OK(snapshot);
    EXPECT_EQ(snapshot->time, needed->first);
    EXPECT_EQ(*snapshot->instances[0].data.at("write"), idf::Data(needed->second));
  }

  ScratchDirectory scratch_;
  Expected expected_;
  std::unique_ptr<StoreReader> reader_;
  Timeline* timeline_ = nullptr;
};

TEST_P(TimelineTest, KnowsItsEndsAndItsNumber) {
  EXPECT_EQ(timeline_->first(), expected_.begin()->first);
  EXPECT_EQ(timeline_->last(), expected_.rbegin()->first);
  EXPECT_EQ(*timeline_->count(), expected_.size());
  EXPECT_EQ((*reader_->index(example_entity()))->size(), expected_.size());
  EXPECT_EQ(reader_->summary(example_entity())->snapshots, expected_.size());
}

TEST_P(TimelineTest, FindsTheNearestOnBothSides) {
  RandomValues random(GetParam() + 1000);
  for (int i = 0; i < 200; ++i) {
    const Time time = time_from_ns(static_cast<int64_t>(random.below(kTimes * 10 + 40)) - 20);
    const auto next = expected_.lower_bound(time);
    expect_entry(timeline_->at_or_after(time), next);
    const auto behind = expected_.upper_bound(time);
    expect_entry(timeline_->at_or_before(time),
                 behind == expected_.begin() ? expected_.end() : std::prev(behind));
  }
}

TEST_P(TimelineTest, WalksInTheOrderOfTime) {
  auto needed = expected_.begin();
  for (std::optional<Time> time = timeline_->first(); time; ++needed) {
    const auto found = timeline_->at_or_after(*time);
    expect_entry(found, needed);
    if (needed == expected_.end() || HasFailure()) break;
    time = time_from_ns(to_ns(needed->first) + 1);
  }
  EXPECT_EQ(needed, expected_.end());
}

TEST_P(TimelineTest, VisitsWhatLiesInASpan) {
  RandomValues random(GetParam() + 2000);
  for (int i = 0; i < 20; ++i) {
    const Time first = time_from_ns(static_cast<int64_t>(random.below(kTimes * 10)) - 20);
    const Time last = time_from_ns(to_ns(first) + static_cast<int64_t>(random.below(300)));
    auto needed = expected_.lower_bound(first);
    EXPECT_OK(timeline_->for_each(first, last, [&](const SnapshotEntry& entry) {
      expect_entry(std::optional(entry), needed);
      if (needed != expected_.end()) ++needed;
      return Status();
    }));
    EXPECT_EQ(needed, expected_.upper_bound(last));
  }
}

TEST_P(TimelineTest, StopsAVisitThatFails) {
  int visits = 0;
  EXPECT_FAILS(timeline_->for_each([&visits](const SnapshotEntry&) {
    return ++visits == 3 ? cancelled("enough") : Status();
  }),
               StatusCode::kCancelled, "enough");
  EXPECT_EQ(visits, 3);
}

TEST_P(TimelineTest, CountsFromTheFirst) {
  uint64_t index = 0;
  for (auto needed = expected_.begin(); needed != expected_.end(); ++needed, ++index)
    expect_entry(timeline_->nth(index), needed);
  expect_entry(timeline_->nth(index), expected_.end());
  expect_entry(timeline_->nth(UINT64_MAX), expected_.end());
}

INSTANTIATE_TEST_SUITE_P(Seeds, TimelineTest, ::testing::Range<uint64_t>(0, 8));

TEST(Timeline, OfNothingIsEmpty) {
  Timeline timeline(example_entity(), {}, {}, nullptr);
  EXPECT_EQ(timeline.first(), std::nullopt);
  EXPECT_EQ(timeline.last(), std::nullopt);
  EXPECT_EQ(*timeline.count(), 0u);
  EXPECT_FALSE(timeline.at_or_after(Time{})->has_value());
  EXPECT_FALSE(timeline.at_or_before(Time{})->has_value());
  EXPECT_FALSE(timeline.nth(0)->has_value());
}

TEST(Timeline, GoesOnWhereAVisitReadsMoreSegmentsThanStayOpen) {
  constexpr int64_t kSegments = 70, kAll = 2 * kSegments;
  const ScratchDirectory scratch;
  ASSERT_OK(create_store(scratch / "store"));
  {
    const auto writer = *StoreWriter::open(scratch / "store", {});
    for (int64_t i = 0; i < kAll; ++i) {
      ASSERT_OK(writer->append({packed_example(i)}, nullptr));
      if (i % 2 == 1) ASSERT_OK(writer->seal());
    }
  }
  const auto reader = *StoreReader::open(scratch / "store");
  ASSERT_EQ(reader->manifest().segments.size(), static_cast<size_t>(kSegments));
  std::vector<SnapshotEntry> seen;
  ASSERT_OK((*reader->timeline(example_entity()))->for_each([&](const SnapshotEntry& entry) {
    seen.push_back(entry);
    if (seen.size() + 1 != kAll) return Status();
    // In the middle of the last segment: all others but one.
    for (const SnapshotEntry& each : seen | std::views::take(kAll - 4))
      ENGRAM_RETURN_IF_ERROR(reader->read_packed(example_entity(), each).status());
    return Status();
  }));
  ASSERT_EQ(seen.size(), static_cast<size_t>(kAll));
  EXPECT_EQ(seen.back().time, example_time(kAll - 1));
}

TEST(Timeline, UnitesRecordedAndLatentForms) {
  const ScratchDirectory scratch;
  ASSERT_OK(create_store(scratch / "store"));
  const auto writer = *StoreWriter::open(scratch / "store", {});
  for (int64_t i = 0; i < 10; ++i)
    ASSERT_OK(writer->append({pack_snapshot(example_snapshot(example_entity(), i))}, nullptr));
  ASSERT_OK(writer->seal());
  const auto model = *temporary_file(scratch / "store", ".model");
  overwrite_file(model, as_bytes("weights"));
  ASSERT_OK(publish_model(scratch / "store", example_entity(), 1, model, example_latents(2, 6, 1)));
  const auto reader = *StoreReader::open(scratch / "store");
  Timeline& timeline = **reader->timeline(example_entity());
  EXPECT_EQ(*timeline.count(), 10u);
  for (int64_t i = 0; i < 10; ++i) {
    const auto entry = timeline.at_or_after(example_time(i));
    ASSERT_OK(entry);
    EXPECT_TRUE((*entry)->recorded.has_value());
    EXPECT_EQ((*entry)->latent.has_value(), i >= 2 && i < 6) << i;
  }
  const auto summary = *reader->summary(example_entity());
  EXPECT_EQ(summary.recorded_snapshots, 10u);
  EXPECT_EQ(summary.latent_snapshots, 4u);
}

}  // namespace
}  // namespace engram::ltm
