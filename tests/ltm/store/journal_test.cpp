// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/journal.h"

#include <sys/resource.h>

#include <csignal>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

using Payload = std::vector<std::byte>;

Payload payload_of(size_t size, uint8_t seed) {
  Payload payload(size);
  for (size_t i = 0; i < size; ++i) payload[i] = static_cast<std::byte>(seed + i * 3);
  return payload;
}

struct Scanned {
  JournalScan scan;
  std::vector<uint64_t> offsets;
  std::vector<Payload> payloads;
};

Result<Scanned> scan(const std::filesystem::path& file) {
  Scanned scanned;
  ENGRAM_ASSIGN_OR_RETURN(
      scanned.scan, scan_journal(file, [&](uint64_t offset, const Buffer& payload) -> Status {
        scanned.offsets.push_back(offset);
        scanned.payloads.emplace_back(payload.bytes().begin(), payload.bytes().end());
        return {};
      }));
  return scanned;
}

class JournalTest : public ::testing::Test {
 protected:
  JournalTest() {
    EXPECT_OK(make_directories(scratch_ / "journal"));
    for (size_t i = 0; i < 5; ++i) payloads_.push_back(payload_of(i * 13, static_cast<uint8_t>(i)));
  }

  [[nodiscard]] std::filesystem::path file(uint64_t number = 1) const {
    return scratch_ / Journal::file_name(number);
  }

  Payload written() {
    auto journal = Journal::create(scratch_.path(), 1);
    EXPECT_OK(journal);
    EXPECT_OK(journal->append(payloads_));
    const auto content = read_file(file());
    return {content->bytes().begin(), content->bytes().end()};
  }

  /// Where the last payload ends; zeros follow up to `size`.
  [[nodiscard]] uint64_t end_of_last_payload(uint64_t size) const {
    return size - (8 - payloads_.back().size() % 8) % 8;
  }

  ScratchDirectory scratch_;
  std::vector<Payload> payloads_;
};

TEST_F(JournalTest, GivesBackEveryFrameInOrder) {
  auto journal = Journal::create(scratch_.path(), 1);
  ASSERT_OK(journal);
  for (const Payload& payload : payloads_) ASSERT_OK(journal->append({&payload, 1}));
  ASSERT_OK(journal->sync(journal->size_bytes()));
  const auto scanned = scan(file());
  ASSERT_OK(scanned);
  EXPECT_EQ(scanned->payloads, payloads_);
  EXPECT_EQ(scanned->scan.frames, payloads_.size());
  EXPECT_EQ(scanned->scan.torn_bytes, 0u);
  EXPECT_EQ(scanned->scan.damaged, 0u);
  EXPECT_EQ(journal->size_bytes(), std::filesystem::file_size(file()));
}

TEST_F(JournalTest, ReadsOneFrameAtItsOffset) {
  written();
  const auto scanned = scan(file());
  const auto opened = File::open(file(), File::Mode::kRead);
  for (size_t i = 0; i < payloads_.size(); ++i) {
    const auto payload = read_journal_frame(*opened, scanned->offsets[i]);
    ASSERT_OK(payload);
    EXPECT_TRUE(std::ranges::equal(payload->bytes(), payloads_[i]));
    EXPECT_EQ(scanned->offsets[i] % 8, 0u);
  }
  EXPECT_FAILS(read_journal_frame(*opened, 0), StatusCode::kDataLoss, "no frame at byte 0");
  EXPECT_FAILS(read_journal_frame(*opened, 1 << 20), StatusCode::kDataLoss, "ends");
}

TEST_F(JournalTest, KeepsEveryWholeFrameWhenTheLastIsTorn) {
  const Payload whole = written();
  const uint64_t last = scan(file())->offsets.back();
  // The padding behind the last payload belongs to no frame.
  const size_t end = last + Journal::kFrameOverheadBytes + payloads_.back().size();
  for (size_t size = last; size < end; ++size) {
    overwrite_file(file(2), {whole.data(), size});
    const auto scanned = scan(file(2));
    ASSERT_OK(scanned);
    EXPECT_EQ(scanned->scan.frames, payloads_.size() - 1) << "cut at byte " << size;
    EXPECT_EQ(scanned->scan.torn_bytes, size - last);
    EXPECT_EQ(scanned->scan.damaged, 0u);
  }
}

TEST_F(JournalTest, SurvivesEveryTruncation) {
  const Payload whole = written();
  for (size_t size = 0; size <= whole.size(); ++size) {
    overwrite_file(file(2), {whole.data(), size});
    const auto scanned = scan(file(2));
    ASSERT_OK(scanned);
    EXPECT_LE(scanned->scan.frames, payloads_.size());
    for (size_t i = 0; i < scanned->payloads.size(); ++i)
      EXPECT_EQ(scanned->payloads[i], payloads_[i]);
  }
}

TEST_F(JournalTest, TellsWhatWasForcedToTheDiskAndIsMissing) {
  auto journal = Journal::create(scratch_.path(), 1);
  ASSERT_OK(journal);
  for (const Payload& payload : payloads_) ASSERT_OK(journal->append({&payload, 1}));
  const uint64_t forced = journal->size_bytes();
  ASSERT_OK(journal->sync(forced));
  const Payload more = payload_of(40, 7);
  ASSERT_OK(journal->append({&more, 1}));
  const Buffer whole = *read_file(file());
  const uint64_t padding = forced - end_of_last_payload(forced);
  for (uint64_t size = 0; size <= whole.size(); ++size) {
    SCOPED_TRACE(size);
    overwrite_file(file(), whole.bytes().subspan(0, size));
    const auto scanned = scan(file());
    ASSERT_OK(scanned);
    EXPECT_EQ(scanned->scan.acknowledged_bytes, forced);
    EXPECT_EQ(scanned->scan.missing_bytes > 0, size + padding < forced);
    EXPECT_EQ(scanned->scan.damaged, size + padding < forced ? 1u : 0u);
    EXPECT_EQ(salvage_journal(file(), [](auto, const auto&) { return Status(); })->missing_bytes,
              scanned->scan.missing_bytes);
  }
  ASSERT_OK(Journal::remove(scratch_.path(), 1));
  EXPECT_TRUE(std::filesystem::is_empty(scratch_ / "journal"));
}

TEST_F(JournalTest, IgnoresANoteThatIsDamaged) {
  auto journal = Journal::create(scratch_.path(), 1);
  ASSERT_OK(journal->append(payloads_));
  ASSERT_OK(journal->sync(journal->size_bytes()));
  const auto note = acknowledged_mark_of(file());
  const Buffer whole = *read_file(note);
  for (uint64_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    damaged[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    overwrite_file(note, damaged);
    EXPECT_EQ(acknowledged_bytes(file()), std::nullopt) << bit;
    overwrite_file(note, whole.bytes());
  }
  for (uint64_t size = 0; size < whole.size(); ++size) {
    overwrite_file(note, whole.bytes().subspan(0, size));
    EXPECT_EQ(acknowledged_bytes(file()), std::nullopt) << size;
  }
}

TEST_F(JournalTest, SkipsAndCountsADamagedFrameInTheMiddle) {
  const Payload whole = written();
  const std::vector<uint64_t> offsets = scan(file())->offsets;
  const size_t end = offsets[2] + Journal::kFrameOverheadBytes + payloads_[2].size();
  for (size_t at = offsets[2]; at < end; ++at) {
    Payload damaged = whole;
    damaged[at] ^= std::byte{0x10};
    overwrite_file(file(2), damaged);
    const auto scanned = scan(file(2));
    ASSERT_OK(scanned);
    EXPECT_EQ(scanned->scan.damaged, 1u) << "byte " << at;
    EXPECT_EQ(scanned->payloads,
              (std::vector{payloads_[0], payloads_[1], payloads_[3], payloads_[4]}));
  }
}

TEST_F(JournalTest, TellsADamagedLastFrameFromATornOne) {
  const Payload whole = written();
  const uint64_t last = scan(file())->offsets.back();
  const size_t end = last + Journal::kFrameOverheadBytes + payloads_.back().size();
  for (size_t size = last + 1; size < end; ++size) {
    overwrite_file(file(2), {whole.data(), size});
    EXPECT_FALSE(scan(file(2))->scan.torn_may_be_damage) << "cut at byte " << size;
  }
  for (size_t bit = last * 8; bit < end * 8; ++bit) {
    Payload damaged = whole;
    damaged[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    overwrite_file(file(2), damaged);
    const auto scanned = scan(file(2));
    ASSERT_OK(scanned);
    EXPECT_TRUE(scanned->scan.torn_may_be_damage) << "bit " << bit;
    EXPECT_EQ(scanned->scan.torn_bytes, whole.size() - last);
  }
}

TEST_F(JournalTest, IsSalvagedWithoutItsBeginning) {
  Payload damaged = written();
  const auto salvage = [this] {
    std::vector<Payload> found;
    const auto scanned = salvage_journal(file(2), [&](uint64_t, const Buffer& payload) -> Status {
      found.emplace_back(payload.bytes().begin(), payload.bytes().end());
      return {};
    });
    EXPECT_OK(scanned);
    EXPECT_EQ(scanned->damaged, 1u);
    return found;
  };
  damaged[3] ^= std::byte{1};
  overwrite_file(file(2), damaged);
  EXPECT_FAILS(scan(file(2)), StatusCode::kDataLoss, "no journal");
  EXPECT_EQ(salvage(), payloads_);
  damaged[9] ^= std::byte{1};
  overwrite_file(file(2), damaged);
  EXPECT_EQ(salvage(), std::vector(payloads_.begin() + 1, payloads_.end()));
  overwrite_file(file(2), payload_of(100, 1));
  EXPECT_TRUE(salvage().empty());
}

TEST_F(JournalTest, NeverInventsAFrame) {
  const Payload whole = written();
  RandomValues random(3);
  for (int i = 0; i < 2000; ++i) {
    Payload damaged = whole;
    for (size_t flips = 1 + random.below(4); flips > 0; --flips)
      damaged[8 + random.below(damaged.size() - 8)] ^=
          static_cast<std::byte>(1 + random.below(255));
    overwrite_file(file(2), damaged);
    const auto scanned = scan(file(2));
    ASSERT_OK(scanned);
    for (const Payload& payload : scanned->payloads)
      EXPECT_NE(std::ranges::find(payloads_, payload), payloads_.end());
  }
}

TEST_F(JournalTest, RefusesAFileThatIsNoJournal) {
  overwrite_file(file(2), as_bytes("something else entirely"));
  EXPECT_FAILS(scan(file(2)), StatusCode::kDataLoss, "no journal");
  EXPECT_FAILS(scan(file(3)), StatusCode::kNotFound, "000003.log");
}

TEST_F(JournalTest, RefusesToReplaceAnExistingFile) {
  written();
  EXPECT_FAILS(Journal::create(scratch_.path(), 1), StatusCode::kAlreadyExists, "000001.log");
}

TEST_F(JournalTest, StopsWhereTheVisitorFails) {
  written();
  const auto scanned =
      scan_journal(file(), [](uint64_t, const Buffer&) -> Status { return cancelled("enough"); });
  EXPECT_FAILS(scanned, StatusCode::kCancelled, "enough");
}

TEST_F(JournalTest, AppendsAgainAfterAWriteThatFailedHalfWay) {
  auto journal = Journal::create(scratch_.path(), 1);
  ASSERT_OK(journal);
  ASSERT_OK(journal->append(payloads_));
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{journal->size_bytes() + 100, old.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  const std::vector<Payload> large{payload_of(1000, 9)};
  const Status failed = journal->append(large);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_FAILS(failed, StatusCode::kUnavailable, "cannot write");
  EXPECT_EQ(journal->size_bytes(), std::filesystem::file_size(file()));

  ASSERT_OK(journal->append(large));
  const auto scanned = scan(file());
  ASSERT_OK(scanned);
  EXPECT_EQ(scanned->scan.frames, payloads_.size() + 1);
  EXPECT_EQ(scanned->scan.damaged, 0u);
  EXPECT_EQ(scanned->payloads.back(), large.front());
}

TEST_F(JournalTest, ListsItsFilesInOrder) {
  for (const uint64_t number : {12, 3, 1'000'001})
    ASSERT_OK(Journal::create(scratch_.path(), number));
  ASSERT_OK(replace_file(scratch_ / "journal/000004.log.damaged", {}));
  ASSERT_OK(replace_file(scratch_ / "journal/notes.txt", {}));
  EXPECT_EQ(*list_journals(scratch_.path()), (std::vector<uint64_t>{3, 12, 1'000'001}));
}

TEST(Journal, OfAStoreWithoutJournalFolderIsEmpty) {
  const ScratchDirectory scratch;
  const auto numbers = list_journals(scratch.path());
  ASSERT_OK(numbers);
  EXPECT_TRUE(numbers->empty());
}

}  // namespace
}  // namespace engram::ltm
