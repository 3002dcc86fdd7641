// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sensory_ring.h"

#include <gmock/gmock.h>

#include <cstring>
#include <random>
#include <thread>

#include "server/sharing/sensory_writer.h"
#include "server/sharing/slab.h"
#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Memory that is mapped twice, as by two processes.
struct MappedTwice {
  explicit MappedTwice(size_t bytes) : slab(std::move(*Slab::create(bytes, false))) {
    const auto memory = slab.descriptor();
    EXPECT_OK(memory);
    written = *Mapping::make(memory->get(), bytes, true);
  }

  Slab slab;
  std::shared_ptr<Mapping> written;
};

/// A ring with both of its ends.
class SensoryRingTest : public ::testing::Test {
 protected:
  explicit SensoryRingTest(size_t bytes = kMinSensoryRing)
      : memory_(bytes),
        words_(reinterpret_cast<uint64_t*>(memory_.written->writable().data()), bytes / 8),
        writer_(memory_.written->writable(), control_, 500ms),
        reader_({memory_.slab.mapping()->data(), bytes}) {}

  /// Writes an entry whose bytes all are the same.
  uint64_t write(size_t bytes, int value, SteadyTime now, uint64_t entities = 1) {
    auto room = writer_.reserve(16, bytes, now, [this] { ++synced_; });
    EXPECT_OK(room);
    std::ranges::fill(room->data, std::byte(value));
    std::ranges::fill(room->head, std::byte(value));
    return writer_.publish(entities, time_from_ns(value), now);
  }

  /// The value that all bytes of an entry have; nothing if it is gone.
  std::optional<int> read(uint64_t sequence) {
    const auto entry = reader_.find(sequence);
    if (!entry) return std::nullopt;
    std::vector<std::byte> bytes(entry->head_bytes + entry->data_bytes);
    if (!reader_.copy(*entry, 0, bytes)) return std::nullopt;
    for (const std::byte one : bytes)
      if (one != bytes[0]) return -1;
    return static_cast<int>(bytes[0]);
  }

  std::vector<int> readable() {
    std::vector<int> values;
    const auto range = reader_.entries();
    for (uint64_t sequence = range.first; sequence < range.end; ++sequence)
      values.push_back(read(sequence).value_or(-2));
    return values;
  }

  MappedTwice memory_;
  std::span<uint64_t> words_;
  SensoryControl control_;
  SensoryRingWriter writer_;
  SensoryRingReader reader_;
  int synced_ = 0;
};

TEST_F(SensoryRingTest, AFreshRingHasNothing) {
  EXPECT_THAT(readable(), IsEmpty());
  EXPECT_FALSE(reader_.find(0).has_value());
}

TEST_F(SensoryRingTest, KeepsEntriesForTheirTime) {
  const SteadyTime now = steady_now();
  for (int i = 0; i < 5; ++i) write(1000, i, now + i * 100ms);
  EXPECT_THAT(readable(), ElementsAre(0, 1, 2, 3, 4));
  write(1000, 5, now + 501ms);
  EXPECT_THAT(readable(), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_EQ(reader_.crowded_out(), 0u);
  EXPECT_EQ(reader_.snapshots(), 6u);
}

TEST_F(SensoryRingTest, CountsWhatIsCrowdedOut) {
  const SteadyTime now = steady_now();
  for (int i = 0; i < 8; ++i) write(15'000, i, now);
  EXPECT_THAT(readable(), ElementsAre(4, 5, 6, 7)) << "60 KiB are for data";
  EXPECT_EQ(reader_.crowded_out(), 4u);
}

TEST_F(SensoryRingTest, WhatPassedIsNotCrowdedOut) {
  const SteadyTime now = steady_now();
  for (int i = 0; i < 4; ++i) write(15'000, i, now, 0b101);
  control_.passed_until[0] = 2;
  write(15'000, 4, now);
  EXPECT_EQ(reader_.crowded_out(), 1u) << "the second entity of the first entry";
  control_.attended = 0b101;
  // The server takes all of it when it is asked.
  ASSERT_OK(writer_.reserve(16, 40'000, now, [this] {
    control_.passed_until[0] = 5;
    control_.passed_until[2] = 5;
  }));
  EXPECT_EQ(reader_.crowded_out(), 1u);
}

TEST_F(SensoryRingTest, LendsRoomThatNothingElseTakes) {
  const SteadyTime now = steady_now();
  const auto nobody = [] {};
  const auto lent = writer_.lend(16, 20'000, now, nobody);
  ASSERT_OK(lent);
  std::ranges::fill(lent->data, std::byte(99));
  for (int i = 0; i < 200; ++i) write(7000, i % 90, now + i * 200ms);
  for (const std::byte one : lent->data) ASSERT_EQ(one, std::byte(99));
  EXPECT_FAILS(writer_.lend(16, 20'000, now, nobody), StatusCode::kResourceExhausted, "are lent");
  EXPECT_FAILS(writer_.reserve(16, 45'000, now, nobody), StatusCode::kResourceExhausted, "needs");
  std::ranges::fill(lent->head, std::byte(99));
  writer_.take_back(*lent, 8, now + 40s, nobody);
  const auto entry = reader_.find(writer_.publish(1, time_from_ns(1), now + 40s));
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->head_bytes, 8u);
  EXPECT_EQ(read(entry->sequence), 99);
  // It is free again after its time, as any other.
  const auto again = writer_.lend(16, 20'000, now + 80s, nobody);
  ASSERT_OK(again);
  writer_.give_back(*again);
  ASSERT_OK(writer_.lend(16, 25'000, now + 80s, nobody));
}

TEST_F(SensoryRingTest, NothingMakesWayForWhatHasNoRoomBesideWhatIsLent) {
  const SteadyTime now = steady_now();
  const auto nobody = [] {};
  write(15'000, 1, now);
  const auto lent = writer_.lend(16, 20'000, now, nobody);
  ASSERT_OK(lent);
  write(15'000, 2, now);
  EXPECT_FAILS(writer_.reserve(16, 30'000, now, nobody), StatusCode::kResourceExhausted,
               "beside each other");
  EXPECT_THAT(readable(), ElementsAre(1, 2));
  EXPECT_EQ(reader_.crowded_out(), 0u);
  writer_.give_back(*lent);
  ASSERT_OK(writer_.reserve(16, 30'000, now, nobody));
}

TEST_F(SensoryRingTest, SaysTheEarliestTimeOfAnEntry) {
  const auto entry = reader_.find(write(10, 7, steady_now()));
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->first_time_ns, 7);
}

TEST_F(SensoryRingTest, RefusesAnEntryThatNeverFits) {
  for (const size_t bytes : {kMinSensoryRing, SIZE_MAX - 8, SIZE_MAX})
    EXPECT_FAILS(writer_.reserve(16, bytes, steady_now(), [] {}), StatusCode::kResourceExhausted,
                 "sensory ring: an entry has");
  EXPECT_THAT(readable(), IsEmpty());
}

TEST_F(SensoryRingTest, HasASlotForEachEntryThatIsThere) {
  const SteadyTime now = steady_now();
  for (int i = 0; i < 1000; ++i) write(0, i % 256, now);
  const auto values = readable();
  EXPECT_EQ(values.size(), 64u);
  for (size_t i = 0; i < values.size(); ++i)
    EXPECT_EQ(values[i], static_cast<int>((1000 - values.size() + i) % 256));
}

TEST_F(SensoryRingTest, TakesNoMoreMemoryThanItHolds) {
  SteadyTime now = steady_now();
  uint64_t end = 0;
  for (int i = 0; i < 2000; ++i, now += 100ms) {
    const auto entry = reader_.find(write(3000, i % 256, now));
    ASSERT_TRUE(entry.has_value());
    end = std::max(end, entry->offset + entry->head_bytes + entry->data_bytes);
  }
  // Six are held at most, while one more is written.
  EXPECT_LE(end - SensoryLayout(kMinSensoryRing).data_begin(), 7u * 3072u);
  EXPECT_EQ(reader_.crowded_out(), 0u);
}

/// Entries of any size, some held and some not, never lie over each other.
TEST_F(SensoryRingTest, EntriesOfAnySizeKeepApart) {
  std::mt19937_64 random(3);
  SteadyTime now = steady_now();
  for (int i = 0; i < 5000; ++i) {
    now += Duration(static_cast<int64_t>(random() % 60'000'000));
    write(random() % (i % 100 == 0 ? 20'000 : 900), i % 256, now);
    const auto values = readable();
    ASSERT_FALSE(values.empty());
    for (size_t at = 0; at < values.size(); ++at)
      ASSERT_EQ(values[values.size() - 1 - at], (i - static_cast<int>(at)) % 256) << i;
  }
}

TEST_F(SensoryRingTest, AsksTheServerBeforeWhatItNeedsIsOverwritten) {
  const SteadyTime now = steady_now();
  write(1000, 1, now);
  write(1000, 2, now);
  write(1000, 3, now + 1s);
  EXPECT_EQ(synced_, 0) << "nobody attends";
  control_.attended = 2;
  control_.taken = 3;
  write(1000, 4, now + 2s);
  EXPECT_EQ(synced_, 0) << "the server has it";
  write(1000, 5, now + 3s);
  EXPECT_EQ(synced_, 1);
  EXPECT_TRUE(writer_.is_attended(3));
  EXPECT_FALSE(writer_.is_attended(1));
  EXPECT_FALSE(writer_.is_closed());
  control_.is_closed = 1;
  EXPECT_TRUE(writer_.is_closed());
}

TEST_F(SensoryRingTest, WhatTheServerIsAskedToTakeIsStillThere) {
  const SteadyTime now = steady_now();
  write(1000, 1, now);
  write(1000, 2, now);
  control_.attended = 1;
  std::vector<int> seen;
  ASSERT_OK(writer_.reserve(16, 1000, now + 1s, [&] { seen = readable(); }));
  EXPECT_THAT(seen, ElementsAre(1, 2));
  EXPECT_THAT(readable(), IsEmpty()) << "they are overwritten from now on";
}

TEST_F(SensoryRingTest, ACopyOfWhatIsOverwrittenMeanwhileIsOfNoUse) {
  const SteadyTime now = steady_now();
  const auto entry = reader_.find(write(1000, 1, now));
  ASSERT_TRUE(entry.has_value());
  std::vector<std::byte> bytes(10);
  EXPECT_TRUE(reader_.copy(*entry, 1006, bytes));
  EXPECT_FALSE(reader_.copy(*entry, 1007, bytes)) << "beyond its end";
  EXPECT_FALSE(reader_.copy(*entry, UINT64_MAX, bytes));
  write(1000, 2, now + 1s);
  EXPECT_FALSE(reader_.copy(*entry, 0, bytes));
  EXPECT_FALSE(reader_.find(0).has_value());
}

TEST_F(SensoryRingTest, BelievesNothingThatTheRingSays) {
  const SteadyTime now = steady_now();
  const uint64_t sequence = write(1000, 1, now);
  const size_t slot = SensoryLayout(kMinSensoryRing).slot_of(sequence) / 8;
  const auto with = [&](size_t word, uint64_t value) {
    const uint64_t before = std::exchange(words_[slot + word], value);
    const bool is_found = reader_.find(sequence).has_value();
    words_[slot + word] = before;
    return is_found;
  };
  ASSERT_TRUE(with(1, 1));
  EXPECT_FALSE(with(0, 5)) << "another entry";
  for (const size_t word : {3, 4, 5})
    for (const uint64_t value : {uint64_t{1} << 20, UINT64_MAX, UINT64_MAX - 63})
      EXPECT_FALSE(with(word, value)) << word << " " << value;
  EXPECT_FALSE(with(3, 0)) << "the counts are no data";
  words_[1] = UINT64_MAX;
  words_[0] = 0;
  const auto range = reader_.entries();
  EXPECT_EQ(range.end - range.first, 64u);
  words_[0] = UINT64_MAX;
  EXPECT_EQ(reader_.entries().first, reader_.entries().end);
}

TEST_F(SensoryRingTest, GarbageIsReadWithinBounds) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    for (uint64_t& word : words_) word = random() >> (random() % 64);
    const auto range = reader_.entries();
    ASSERT_LE(range.end - range.first, 64u);
    for (uint64_t sequence = range.first; sequence < range.end; ++sequence) read(sequence);
  }
}

/// A writer that goes on as fast as it can while its entries are copied.
class BusyRingTest : public SensoryRingTest {
 protected:
  BusyRingTest() : SensoryRingTest(size_t{1} << 20) {}
};

TEST_F(BusyRingTest, NoTornEntryIsTakenForWhole) {
  std::jthread writing([this](const std::stop_token& stop) {
    for (int i = 0; !stop.stop_requested(); ++i)
      // Nothing is held for its time: there is room for some entries only.
      write(100'000 + 1000 * static_cast<size_t>(i % 7), i % 200, steady_now());
  });
  uint64_t whole = 0;
  uint64_t gone = 0;
  const SteadyTime end = steady_now() + 2s;
  while (steady_now() < end || gone == 0) {
    const auto range = reader_.entries();
    if (range.first == range.end) continue;
    // The next one that is overwritten.
    const auto value = read(range.first);
    ASSERT_NE(value, -1);
    if (value) {
      ASSERT_EQ(*value, static_cast<int>(range.first % 200));
    }
    ++(value ? whole : gone);
  }
  EXPECT_GT(whole, 100u);
}

}  // namespace
}  // namespace engram::server
