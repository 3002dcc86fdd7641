// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_writer.h"

#include <sys/resource.h>

#include <csignal>
#include <functional>
#include <thread>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/store/journal.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/store_reader.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

class StoreWriterTest : public ::testing::Test {
 protected:
  StoreWriterTest() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  std::unique_ptr<StoreWriter> open(const StoreWriter::Options& options = {}) {
    return *StoreWriter::open(store_, options, [this] { return now_; });
  }

  void expect_examples(int64_t count) {
    const auto reader = StoreReader::open(store_);
    ASSERT_OK(reader);
    const auto found = read_all(**reader, example_entity());
    ASSERT_OK(found);
    ASSERT_EQ(found->size(), static_cast<size_t>(count));
    for (int64_t i = 0; i < count; ++i)
      EXPECT_EQ((*found)[static_cast<size_t>(i)], example_snapshot(example_entity(), i));
  }

  void expect_example_times(const std::vector<int64_t>& indices) {
    const auto reader = *StoreReader::open(store_);
    const auto& entries = **reader->index(example_entity());
    ASSERT_EQ(entries.size(), indices.size());
    for (size_t i = 0; i < indices.size(); ++i)
      EXPECT_EQ(entries[i].time, example_time(indices[i]));
  }

  /// Sealing happens beside us.
  static bool eventually(const std::function<bool()>& is_so) {
    for (int i = 0; i < 2000 && !is_so(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return is_so();
  }

  [[nodiscard]] size_t files_in(const char* folder) const {
    size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(store_ / folder))
      ++count;
    return count;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
  Time now_ = example_time(0);
};

TEST_F(StoreWriterTest, ShowsUnsealedDataToReaders) {
  const auto writer = open();
  for (int64_t i = 0; i < 20; ++i) {
    ASSERT_OK(writer->append({packed_example(i)}, nullptr));
    if (i % 7 == 0) expect_examples(i + 1);
  }
  EXPECT_EQ(files_in("segments"), 0u);
  expect_examples(20);
}

TEST_F(StoreWriterTest, KeepsEverythingReadableBySealing) {
  const auto writer = open();
  for (int64_t i = 0; i < 30; ++i) {
    ASSERT_OK(writer->append({packed_example(i)}, nullptr));
    if (i % 10 == 5) {
      ASSERT_OK(writer->seal());
    }
  }
  EXPECT_EQ(files_in("segments"), 3u);
  EXPECT_EQ(files_in("journal"), 2u);  // The journal and what it acknowledged.
  expect_examples(30);
  ASSERT_OK(writer->seal());
  EXPECT_EQ(files_in("journal"), 0u);
  ASSERT_OK(writer->seal());
  EXPECT_EQ(files_in("segments"), 4u);
  expect_examples(30);
}

TEST_F(StoreWriterTest, SealsByItselfBySizeAndByAge) {
  auto writer = open({.seal_bytes = 4000, .seal_after = std::chrono::hours(1)});
  for (int64_t i = 0; i < 40; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
  const auto has_segments = [this](size_t count) { return files_in("segments") >= count; };
  EXPECT_TRUE(eventually([&] { return has_segments(2); }));
  now_ += std::chrono::hours(2);
  ASSERT_OK(writer->append({packed_example(40)}, nullptr));
  EXPECT_TRUE(eventually([&] { return files_in("journal") == 0; }));
  expect_examples(41);
}

TEST_F(StoreWriterTest, ReportsTheBytesOfEachFrame) {
  const auto writer = open();
  std::vector<uint64_t> bytes;
  ASSERT_OK(writer->append({packed_example(0), packed_example(1, example_entity("b"))}, &bytes));
  ASSERT_EQ(bytes.size(), 2u);
  const uint64_t file = std::filesystem::file_size(store_ / Journal::file_name(1));
  EXPECT_LE(bytes[0] + bytes[1], file);
  EXPECT_GE(bytes[0] + bytes[1] + 8 + 2 * 7, file);
}

TEST_F(StoreWriterTest, TakesOverWhatAnEarlierWriterLeft) {
  {
    const auto writer = open();
    for (int64_t i = 0; i < 5; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
  }
  const auto writer = open();
  EXPECT_EQ(writer->last_time(example_entity()), example_time(4));
  EXPECT_EQ(writer->last_time(example_entity("other")), std::nullopt);
  for (int64_t i = 5; i < 10; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
  expect_examples(10);
  ASSERT_OK(writer->seal());
  expect_examples(10);
}

TEST_F(StoreWriterTest, RemembersTimesOfSealedSnapshots) {
  {
    const auto writer = open();
    ASSERT_OK(writer->append({packed_example(3)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  EXPECT_EQ(open()->last_time(example_entity()), example_time(3));
}

TEST_F(StoreWriterTest, RefusesASecondWriter) {
  const auto writer = open();
  EXPECT_FAILS(StoreWriter::open(store_, {}), StatusCode::kFailedPrecondition, "another process");
}

TEST_F(StoreWriterTest, TakesLateSnapshotsAndUpdates) {
  const auto writer = open();
  PackedSnapshot first = pack_snapshot(example_snapshot(example_entity(), 7));
  first.time = example_time(1);
  ASSERT_OK(writer->append({packed_example(2), first}, nullptr));
  expect_example_times({1, 2});
  ASSERT_OK(writer->append({packed_example(1)}, nullptr));
  ASSERT_OK(writer->append({packed_example(0)}, nullptr));
  EXPECT_EQ(writer->last_time(example_entity()), example_time(2));
  expect_examples(3);
  ASSERT_OK(writer->seal());
  expect_examples(3);
}

TEST_F(StoreWriterTest, PutsAnUpdateOverASealedSnapshot) {
  const auto writer = open();
  PackedSnapshot first = pack_snapshot(example_snapshot(example_entity(), 7));
  first.time = example_time(1);
  ASSERT_OK(writer->append({packed_example(0), first, packed_example(2)}, nullptr));
  ASSERT_OK(writer->seal());
  ASSERT_OK(writer->append({packed_example(1)}, nullptr));
  expect_examples(3);
  ASSERT_OK(writer->seal());
  expect_examples(3);
}

TEST_F(StoreWriterTest, StopsBeforeTheDiskIsFull) {
  const auto writer = open({.min_free_bytes = UINT64_MAX});
  EXPECT_FAILS(writer->append({packed_example(0)}, nullptr), StatusCode::kResourceExhausted,
               "bytes left, recording needs");
  EXPECT_EQ(files_in("journal"), 0u);
}

TEST_F(StoreWriterTest, RefusesOptionsThatCannotWork) {
  EXPECT_FAILS(StoreWriter::open(store_, {.seal_bytes = 0}), StatusCode::kInvalidArgument,
               "seal_bytes");
  EXPECT_FAILS(StoreWriter::open(store_, {.sync_interval = Duration(0)}),
               StatusCode::kInvalidArgument, "sync_interval");
  EXPECT_FAILS(StoreWriter::open(store_, {.max_waiting_journals = 0}), StatusCode::kInvalidArgument,
               "max_waiting_journals");
}

TEST_F(StoreWriterTest, RefusesWhatCouldNotBeSealed) {
  const auto writer = open();
  PackedSnapshot packed = packed_example(0);
  packed.entity = *MemoryId::from_names({"Vision", "RGB"});
  EXPECT_FAILS(writer->append({packed}, nullptr), StatusCode::kInvalidArgument, "no entity");
  EXPECT_FAILS(writer->append_dropped(packed.entity, 1, 1), StatusCode::kInvalidArgument,
               "no entity");
  packed = packed_example(0);
  packed.instances.clear();
  EXPECT_FAILS(writer->append({packed}, nullptr), StatusCode::kInvalidArgument, "no instances");
  packed = packed_example(0);
  packed.instances[0].metadata.provider = std::string("a\0b", 3);
  EXPECT_FAILS(writer->append({packed}, nullptr), StatusCode::kInvalidArgument, "zero byte");
  ASSERT_OK(writer->append({}, nullptr));
  EXPECT_EQ(files_in("journal"), 0u);
}

TEST_F(StoreWriterTest, SealsWhateverItAcknowledged) {
  RandomValues random(41);
  const auto writer = open();
  std::vector<Snapshot> written;
  for (int64_t i = 0; i < 200; ++i) {
    idf::Data value = random.value(4);
    if (i % 20 == 0) value = nested_lists(64);
    if (i % 20 == 1) value = nested_dicts(64);
    written.push_back({example_entity(), example_time(i), {{value, example_metadata(i)}}});
    ASSERT_OK(writer->append({pack_snapshot(written.back())}, nullptr));
  }
  ASSERT_OK(writer->seal());
  EXPECT_EQ(files_in("journal"), 0u);
  const auto reader = StoreReader::open(store_);
  const auto found = read_all(**reader, example_entity());
  ASSERT_OK(found);
  EXPECT_EQ(*found, written);
}

TEST_F(StoreWriterTest, RemovesWhatKilledWritersLeft) {
  open();
  for (const char* name : {"tmp/1999999999-0.h5", "tmp/junk", "segments/000077.h5", "models/x.h5"})
    ASSERT_OK(replace_file(store_ / name, as_bytes("left over")));
  const std::filesystem::path own = store_ / "tmp" / fmt::format("{}-9.h5", ::getpid());
  ASSERT_OK(replace_file(own, as_bytes("in use")));
  open();
  EXPECT_EQ(files_in("segments"), 0u);
  EXPECT_EQ(files_in("models"), 0u);
  EXPECT_EQ(files_in("tmp"), 1u);
  EXPECT_TRUE(std::filesystem::exists(own));
}

TEST_F(StoreWriterTest, MakesFoldersAgainThatACopyLeftOut) {
  for (const char* folder : {"tmp", "models", "segments", "journal"})
    std::filesystem::remove(store_ / folder);
  ASSERT_OK(StoreReader::open(store_));
  const auto writer = open();
  ASSERT_OK(writer->append({packed_example(0)}, nullptr));
  ASSERT_OK(writer->seal());
  expect_examples(1);
}

TEST_F(StoreWriterTest, CountsDamagedPlacesAndKeepsTheRest) {
  {
    const auto writer = open();
    for (int64_t i = 0; i < 5; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
  }
  const std::filesystem::path file = store_ / Journal::file_name(1);
  std::vector<uint64_t> offsets;
  ASSERT_OK(scan_journal(file, [&](uint64_t offset, const Buffer&) {
    offsets.push_back(offset);
    return Status();
  }));
  const Buffer whole = *read_file(file);
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  damaged[offsets[2] + 40] ^= std::byte{1};
  ASSERT_OK(replace_file(file, damaged));
  log::set_level(log::Level::kOff);
  const auto writer = open();
  EXPECT_EQ(writer->lost_frames(), 1u);
  EXPECT_EQ((*StoreReader::open(store_))->damaged_places(), 1u);
  ASSERT_OK(writer->seal());
  const auto reader = StoreReader::open(store_);
  EXPECT_EQ((*reader)->damaged_places(), 1u);
  EXPECT_EQ((*reader)->index(example_entity()).value()->size(), 4u);
  EXPECT_TRUE(std::filesystem::exists(file.string() + ".damaged"));
}

TEST_F(StoreWriterTest, AcknowledgesWhereSealingFailsAndTriesAgain) {
  // HDF5 files cannot be written: "tmp" is no directory.
  std::filesystem::remove(store_ / "tmp");
  log::set_level(log::Level::kOff);
  auto writer = open({.seal_bytes = 1});
  std::filesystem::remove(store_ / "tmp");
  ASSERT_OK(replace_file(store_ / "tmp", {}));
  ASSERT_OK(writer->append({packed_example(0)}, nullptr));
  EXPECT_FALSE(writer->seal().ok());
  expect_examples(1);
  ASSERT_OK(writer->append({packed_example(1)}, nullptr));
  EXPECT_FALSE(writer->seal().ok());
  EXPECT_EQ(files_in("segments"), 0u);
  expect_examples(2);
  std::filesystem::remove(store_ / "tmp");
  ASSERT_OK(writer->append({packed_example(2)}, nullptr));
  ASSERT_OK(writer->seal());
  EXPECT_EQ(files_in("journal"), 0u);
  expect_examples(3);
}

TEST_F(StoreWriterTest, LeavesNothingBehindWhereTheDiskIsFull) {
  const auto writer = open();
  for (int64_t i = 0; i < 200; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  // The disk is full at every place of the segment, once.
  int failed = 0;
  bool is_sealed = false;
  for (rlim_t limit = 500; !is_sealed; limit += 500, ++failed) {
    const rlimit tight{limit, old.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
    is_sealed = writer->seal().ok();
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
    EXPECT_EQ(files_in("tmp"), 0u);
    EXPECT_EQ(files_in("segments"), is_sealed ? 1u : 0u);
    if (is_sealed || limit % 5000 == 0) expect_examples(200);
  }
  std::signal(SIGXFSZ, old_handler);
  EXPECT_GT(failed, 10);
  EXPECT_EQ(files_in("journal"), 0u);
}

TEST_F(StoreWriterTest, SealsValuesWithTheTypesThatTheyCameUnder) {
  const MemoryId core = example_entity().parent().parent();
  const idf::Type first = idf::Type::dict(idf::Type::float64());
  const idf::Type second = idf::Type::dict(idf::Type::float32());
  auto writer = open();
  ASSERT_OK(writer->declare(core, first));
  ASSERT_OK(writer->append({pack_snapshot(example_snapshot(example_entity(), 0))}, nullptr));
  ASSERT_OK(writer->declare(core, first));  // Again: changes nothing.
  EXPECT_EQ(files_in("segments"), 0u);
  ASSERT_OK(writer->declare(core, second));
  ASSERT_OK(writer->append({pack_snapshot(example_snapshot(example_entity(), 1))}, nullptr));
  ASSERT_OK(writer->seal());
  const auto reader = *StoreReader::open(store_);
  EXPECT_EQ(*reader->manifest().types.find(core), second);
  ASSERT_EQ(reader->manifest().segments.size(), 2u);
  const idf::Type expected[] = {first, second};
  for (size_t i = 0; i < 2; ++i) {
    const auto segment = *SegmentReader::open(store_ / reader->manifest().segments[i].file);
    const auto types = segment->types();
    ASSERT_OK(types);
    EXPECT_EQ(*types->find(core), expected[i]);
  }
  expect_examples(2);
}

TEST_F(StoreWriterTest, RefusesATypeThatDoesNotExtendTheCoreType) {
  auto writer = open();
  ASSERT_OK(writer->declare(*MemoryId::parse("a/b"), idf::Type::int32()));
  EXPECT_FAILS(writer->declare(*MemoryId::parse("a/b/c"), idf::Type::string()),
               StatusCode::kInvalidArgument, "'a/b/c' must extend core segment 'a/b'");
  EXPECT_EQ((*StoreReader::open(store_))->manifest().types, writer->types());
}

}  // namespace
}  // namespace engram::ltm
