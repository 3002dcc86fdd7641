// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/access_log.h"

#include <sys/wait.h>
#include <unistd.h>

#include "ltm/idf/binary.h"
#include "ltm/recall/recall.h"
#include "ltm/store/journal.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

class AccessLogTest : public ::testing::Test {
 protected:
  AccessLogTest() { EXPECT_OK(make_directories(store_)); }

  [[nodiscard]] Clock clock() {
    return [this] { return now_; };
  }

  /// What another process notes, which ends right away.
  void note_elsewhere(int64_t index, int count) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      {
        AccessLog log(store_, {}, clock());
        for (int i = 0; i < count; ++i) log.note(example_entity(), example_time(index));
      }
      ::_exit(0);
    }
    ::waitpid(child, nullptr, 0);
  }

  [[nodiscard]] std::vector<std::filesystem::path> logs() const {
    std::vector<std::filesystem::path> found;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(store_ / "access", none))
      if (entry.path().extension() == ".log") found.push_back(entry.path());
    return found;
  }

  [[nodiscard]] uint64_t reads(int64_t index) const {
    return read_accesses(store_).find(example_entity(), example_time(index)).count;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_ = scratch_ / "store";
  Time now_ = example_time(1000);
};

TEST_F(AccessLogTest, CountsReadsAndKnowsTheLast) {
  {
    AccessLog log(store_, {}, clock());
    log.note(example_entity(), example_time(1));
    now_ += std::chrono::seconds(1);
    log.note(example_entity(), example_time(1));
    log.note(example_entity("other"), example_time(1));
  }
  const AccessTable table = read_accesses(store_);
  EXPECT_EQ(table.find(example_entity(), example_time(1)), (AccessStats{2, now_}));
  EXPECT_EQ(table.find(example_entity("other"), example_time(1)).count, 1u);
  EXPECT_EQ(table.find(example_entity(), example_time(2)).count, 0u);
}

TEST_F(AccessLogTest, MakesNoFileWhereNothingIsRead) {
  { const AccessLog log(store_, {}, clock()); }
  EXPECT_TRUE(logs().empty());
  EXPECT_TRUE(read_accesses(store_).empty());
  EXPECT_OK(merge_accesses(store_));
}

TEST_F(AccessLogTest, WritesInBatchesAndAfterAWhile) {
  AccessLog log(store_, {.batch = 3, .interval = std::chrono::seconds(5)}, clock());
  log.note(example_entity(), example_time(1));
  log.note(example_entity(), example_time(1));
  EXPECT_EQ(reads(1), 0u);
  log.note(example_entity(), example_time(1));
  EXPECT_EQ(reads(1), 3u);
  log.note(example_entity(), example_time(2));
  now_ += std::chrono::seconds(5);
  log.note(example_entity(), example_time(2));
  EXPECT_EQ(reads(2), 2u);
}

TEST_F(AccessLogTest, BeginsANewFileAtTheLimitAndEndsAtTheLimitOfAll) {
  AccessLog log(store_, {.batch = 1, .file_bytes = 1000, .max_bytes = 3000}, clock());
  for (int i = 0; i < 200; ++i) log.note(example_entity(), example_time(i));
  EXPECT_GE(logs().size(), 3u);
  uint64_t bytes = 0;
  for (const auto& file : logs()) bytes += std::filesystem::file_size(file);
  EXPECT_LT(bytes, 5000u);
  EXPECT_EQ(reads(0), 1u);
  EXPECT_EQ(reads(199), 0u) << "dropped, not failed";
}

TEST_F(AccessLogTest, MergingKeepsCountsAndLeavesOneFile) {
  for (int i = 0; i < 5; ++i) note_elsewhere(i % 2, 2);
  EXPECT_EQ(logs().size(), 5u);
  for (int round = 0; round < 2; ++round) {
    ASSERT_OK(merge_accesses(store_));
    EXPECT_EQ(logs().size(), 1u);
    EXPECT_EQ(reads(0), 6u);
    EXPECT_EQ(reads(1), 4u);
  }
  note_elsewhere(0, 1);
  EXPECT_EQ(reads(0), 7u);
  ASSERT_OK(merge_grown_accesses(store_));
  EXPECT_EQ(logs().size(), 2u) << "it has not grown";
}

TEST_F(AccessLogTest, MergingLeavesWhatAReaderHasOpen) {
  AccessLog log(store_, {.batch = 1}, clock());
  log.note(example_entity(), example_time(3));
  ASSERT_OK(merge_accesses(store_));
  log.note(example_entity(), example_time(3));
  EXPECT_EQ(reads(3), 2u);
}

TEST_F(AccessLogTest, ALogThatIsMergedAndStillThereCountsOnce) {
  note_elsewhere(1, 2);
  const auto log = logs().front();
  const Buffer content = *read_file(log);
  ASSERT_OK(merge_accesses(store_));
  overwrite_file(log, content.bytes());  // Killed before it was removed.
  EXPECT_EQ(reads(1), 2u);
  ASSERT_OK(merge_accesses(store_));
  EXPECT_EQ(reads(1), 2u);
  EXPECT_EQ(logs().size(), 1u);
}

TEST_F(AccessLogTest, MergingForgetsWhatWentFromTheStore) {
  note_elsewhere(1, 1);
  note_elsewhere(2, 1);
  ASSERT_OK(merge_accesses(store_, {{example_entity(), {example_time(1)}}}));
  EXPECT_EQ(reads(1), 0u);
  EXPECT_EQ(reads(2), 1u);
}

TEST_F(AccessLogTest, DamageCostsNotesAndNothingElse) {
  note_elsewhere(1, 1);
  const auto log = logs().front();
  const Buffer whole = *read_file(log);
  for (size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    damaged[i] ^= std::byte{0x41};
    overwrite_file(log, damaged);
    EXPECT_LE(reads(1), 1u) << i;
    overwrite_file(log, whole.bytes().subspan(0, i));
    EXPECT_LE(reads(1), 1u) << i;
  }
  overwrite_file(store_ / "access/summary.log", as_bytes("nonsense"));
  overwrite_file(log, whole.bytes());
  EXPECT_EQ(reads(1), 1u);
}

TEST_F(AccessLogTest, CountsBeyondAllMeasureAreTheSameAfterMerging) {
  const auto max = idf::NdArray::take<int64_t>({1}, {INT64_MAX});
  const auto frame = *idf::encode(
      idf::Dict{{"entity", example_entity().to_string()},
                {"snapshots", idf::NdArray::take<int64_t>({1}, {to_ns(example_time(1))})},
                {"counts", max},
                {"last", max}});
  std::vector<std::byte> log(as_bytes(kJournalMagic).begin(), as_bytes(kJournalMagic).end());
  const auto frames = *encode_journal_frames(std::vector{frame, frame});
  log.insert(log.end(), frames.begin(), frames.end());
  ASSERT_OK(make_directories(store_ / "access"));
  ASSERT_OK(replace_file(store_ / "access" / "1-1.log", log));
  EXPECT_EQ(reads(1), static_cast<uint64_t>(INT64_MAX));
  ASSERT_OK(merge_accesses(store_));
  EXPECT_EQ(reads(1), static_cast<uint64_t>(INT64_MAX));
}

TEST_F(AccessLogTest, AStoreThatCannotBeWrittenToIsReadAllTheSame) {
  overwrite_file(store_ / "access", as_bytes("a file where the folder should be"));
  AccessLog log(store_, {.batch = 1}, clock());
  log.note(example_entity(), example_time(1));
  EXPECT_EQ(reads(1), 0u);
}

TEST_F(AccessLogTest, RecallNotesWhatItAnswersWithDataOnly) {
  const auto store = scratch_ / "real";
  ASSERT_OK(create_store(store));
  {
    const auto writer = *StoreWriter::open(store, {});
    for (int64_t i = 0; i < 3; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto ask = [&](const Query& query, bool is_noted) {
    auto log = is_noted ? std::make_unique<AccessLog>(store, AccessLog::Options{}) : nullptr;
    Recall recall(*StoreReader::open(store), {}, std::move(log));
    EXPECT_OK(recall.query(query));
  };
  const std::string cam = example_entity().to_string();
  ask(*Query::parse(cam + " @ all"), false);
  ask(*Query::parse("?ids " + cam + " @ all"), true);
  ask(*Query::parse(cam + " @ +1s"), true);
  EXPECT_TRUE(read_accesses(store).empty());
  ask(*Query::parse(cam + " @ latest:2"), true);
  ask(*Query::parse(cam + " @ latest, all#7"), true);
  const AccessTable table = read_accesses(store);
  EXPECT_EQ(table.find(example_entity(), example_time(0)).count, 0u);
  EXPECT_EQ(table.find(example_entity(), example_time(1)).count, 1u);
  EXPECT_EQ(table.find(example_entity(), example_time(2)).count, 2u);
}

}  // namespace
}  // namespace engram::ltm
