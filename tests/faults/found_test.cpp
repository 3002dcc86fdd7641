// SPDX-License-Identifier: Apache-2.0
// What the faults brought to light, each in its shortest form.
#include <gtest/gtest.h>

#include "ltm/core/file.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_writer.h"
#include "tests/faults/faulty_files.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm::faults {
namespace {

/// Appends example snapshots [0, count) with a number that tells one round from the next, seals.
void record(const std::filesystem::path& store, int64_t count, int64_t round) {
  const auto writer = *StoreWriter::open(store, {});
  for (int64_t i = 0; i < count; ++i) {
    Snapshot snapshot = example_snapshot(example_entity(), i);
    snapshot.instances.front().data.get_if<idf::Dict>()->set("round", round);
    ASSERT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
  }
  ASSERT_OK(writer->seal());
}

TEST(Found, AnOlderFormDoesNotComeBackWhereAnUpdatedSnapshotIsDropped) {
  const ScratchDirectory scratch;
  const std::filesystem::path store = scratch / "store";
  ASSERT_OK(create_store(store));
  record(store, 4, 0);
  record(store, 4, 1);  // Updates every one of them.
  const auto file = temporary_file(store, ".model");
  ASSERT_OK(file);
  ASSERT_OK(replace_file(*file, as_bytes("weights")));
  ASSERT_OK(publish_model(store, example_entity(), 1, *file, example_latents(0, 4, 1)));
  const auto dropped = drop_recorded(store, example_entity(), {});
  ASSERT_OK(dropped);
  EXPECT_EQ(dropped->snapshots, 4u);
  const auto reader = StoreReader::open(store);
  ASSERT_OK(reader);
  const auto found = read_all(**reader, example_entity());
  ASSERT_OK(found);
  EXPECT_THAT(*found, testing::IsEmpty()) << "values of round 0 are back";
  EXPECT_EQ((*(*reader)->index(example_entity()))->size(), 4u) << "the latents are there";
}

/// A directory on a disk that can die.
class MortalDirectory : public ScratchDirectory {
 public:
  MortalDirectory() { faulty_files_watch(path().c_str()); }
  ~MortalDirectory() { revive(); }

  /// From now on every change fails.
  static void kill() { faulty_files_fail(1, kFaultDead); }
  static void revive() { faulty_files_fail(0, kFaultNone); }
};

TEST(Found, ALastSyncThatFailsIsTold) {
  for (const Durability level : {Durability::kInterval, Durability::kNone}) {
    const MortalDirectory scratch;
    ASSERT_OK(create_store(scratch / "store"));
    const StoreWriter::Options options{.durability = level, .sync_interval = std::chrono::hours(1)};
    const auto writer = *StoreWriter::open(scratch / "store", options);
    const std::vector<PackedSnapshot> two = {pack_snapshot(example_snapshot(example_entity(), 0)),
                                             pack_snapshot(example_snapshot(example_entity(), 1))};
    ASSERT_OK(writer->append({two[0]}, nullptr));
    ASSERT_OK(writer->sync());
    ASSERT_OK(writer->append({two[1]}, nullptr));
    MortalDirectory::kill();
    EXPECT_FAILS(writer->sync(), StatusCode::kUnavailable, "000001.log");
    EXPECT_OK(writer->sync());  // An error is told once.
  }
}

TEST(Found, AJournalThatWaitsToBeSealedIsForcedToo) {
  const MortalDirectory scratch;
  ASSERT_OK(create_store(scratch / "store"));
  const auto writer =
      *StoreWriter::open(scratch / "store", {.durability = Durability::kNone, .min_free_bytes = 0});
  ASSERT_OK(writer->append({pack_snapshot(example_snapshot(example_entity(), 0))}, nullptr));
  MortalDirectory::kill();
  EXPECT_FALSE(writer->seal().ok());
  EXPECT_FAILS(writer->sync(), StatusCode::kUnavailable, "000001.log");
}

TEST(Found, ARecorderTellsThatItsJournalIsNotOnTheDisk) {
  const MortalDirectory scratch;
  auto recorder = Recorder::open(scratch / "store", {});
  ASSERT_OK(recorder);
  ASSERT_OK(recorder->commit(Commit{{example_snapshot(example_entity(), 0)}}));
  MortalDirectory::kill();
  EXPECT_FAILS(recorder->close(), StatusCode::kUnavailable, "a power cut may cost what was kept");
}

}  // namespace
}  // namespace engram::ltm::faults
