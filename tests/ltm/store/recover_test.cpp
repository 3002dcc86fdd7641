// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/recover.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "ltm/store/checksum.h"
#include "ltm/store/journal.h"
#include "tests/ltm/store/full_store.h"

namespace engram::ltm {
namespace {

using ::testing::HasSubstr;

/// Every file of a directory with its checksum.
std::map<std::string, uint64_t> files_of(const std::filesystem::path& directory) {
  std::map<std::string, uint64_t> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(directory).string()] = *checksum_of_file(entry.path());
  return files;
}

class RecoverTest : public ::testing::Test {
 protected:
  RecoverTest() : store_(FullStore::make(scratch_ / "store")) {}

  /// Recovers into "copy", which must be clean afterwards; the source must be as it was.
  RecoverReport recover(const RecoverOptions& options = {}) {
    std::filesystem::remove_all(copy_);
    const auto before = files_of(store_.path);
    const auto report = recover_store(store_.path, copy_, options);
    EXPECT_OK(report);
    EXPECT_EQ(files_of(store_.path), before);
    const auto checked = check_store(copy_, {true, {}});
    EXPECT_OK(checked);
    for (const Finding& finding : checked.value_or(CheckReport()).findings)
      EXPECT_EQ(finding.severity, Severity::kNote) << finding.file << ": " << finding.what;
    return report.value_or(RecoverReport());
  }

  void expect_content(uint64_t recorded, uint64_t latent) {
    const ReadBack found = read_back(store_, copy_);
    EXPECT_EQ(found.recorded, recorded);
    EXPECT_EQ(found.latent, latent);
    EXPECT_EQ(found.wrong, 0u);
    EXPECT_EQ(found.failed, 0u);
  }

  void remove_manifest() { std::filesystem::remove(store_.path / "MANIFEST.json"); }

  ScratchDirectory scratch_;
  FullStore store_;
  std::filesystem::path copy_ = scratch_ / "copy";
};

TEST_F(RecoverTest, OfAWholeStoreIsItsCopy) {
  const RecoverReport report = recover();
  EXPECT_FALSE(report.has_loss());
  EXPECT_FALSE(report.is_rebuilt);
  EXPECT_EQ(report.segments_copied, 3u);
  EXPECT_EQ(report.models, 1u);
  EXPECT_EQ(report.entities.at(example_entity()).recorded, 40u);
  EXPECT_EQ(report.entities.at(example_entity()).latent, 30u);
  EXPECT_EQ(report.entities.at(example_entity()).unsealed, 10u);
  expect_content(kFullRecorded, kFullLatent);
  auto files = files_of(copy_);
  auto original = files_of(store_.path);
  for (auto* of : {&files, &original}) {
    of->erase("MANIFEST.json");
    of->erase("WRITER.lock");
    of->erase("MANIFEST.lock");
  }
  EXPECT_EQ(files, original);
  EXPECT_EQ(read_manifest(copy_)->types, read_manifest(store_.path)->types);
  EXPECT_EQ(read_manifest(copy_)->store_id, read_manifest(store_.path)->store_id);
}

TEST_F(RecoverTest, GivesAStoreThatGoesOn) {
  recover();
  const auto writer = StoreWriter::open(copy_, {});
  ASSERT_OK(writer);
  store_.append(**writer, example_entity(), 60, 65);
  ASSERT_OK((*writer)->seal());
  expect_content(kFullRecorded + 5, kFullLatent);
}

TEST_F(RecoverTest, WithoutAManifestFindsEverythingInTheFiles) {
  const Manifest before = *read_manifest(store_.path);
  remove_manifest();
  const RecoverReport report = recover();
  EXPECT_TRUE(report.is_rebuilt);
  EXPECT_FALSE(report.has_loss());
  expect_content(kFullRecorded, kFullLatent);
  const Manifest after = *read_manifest(copy_);
  EXPECT_EQ(after.types, before.types);
  ASSERT_EQ(after.segments.size(), before.segments.size());
  for (size_t i = 0; i < after.segments.size(); ++i) {
    EXPECT_EQ(after.segments[i].file, before.segments[i].file);
    EXPECT_EQ(after.segments[i].checksum, before.segments[i].checksum);
    const SegmentEntity& found = after.segments[i].entities.at(0);
    const SegmentEntity& told = before.segments[i].entities.at(0);
    EXPECT_EQ(found.snapshots, told.snapshots);
    EXPECT_EQ(found.raw_bytes, told.raw_bytes);
    EXPECT_EQ(found.stored_bytes, told.stored_bytes);
    EXPECT_EQ(found.latent.model_version, told.latent.model_version);
    EXPECT_EQ(found.latent.psnr_db, told.latent.psnr_db);
  }
  EXPECT_EQ(after.next_segment, before.next_segment);
}

TEST_F(RecoverTest, SavesAllButTheDamagedSnapshotOfASegment) {
  flip_bit(store_.path / "segments/000001.h5",
           std::filesystem::file_size(store_.path / "segments/000001.h5") * 4);
  const RecoverReport report = recover();
  const RecoveredEntity& cam = report.entities.at(example_entity());
  EXPECT_EQ(report.segments_rewritten, 1u);
  EXPECT_EQ(cam.recorded + cam.recorded_lost, 40u);
  EXPECT_EQ(report.has_loss(), cam.recorded_lost > 0);
  expect_content(kFullRecorded - cam.recorded_lost, kFullLatent);
  // What the filters dropped stays counted.
  EXPECT_EQ(read_manifest(copy_)->segments[0].entities[0].dropped, 42u);
}

TEST_F(RecoverTest, OverwritesNothingWhereNumbersAreWrong) {
  ASSERT_OK(edit_manifest(store_.path, [](Manifest& manifest) -> Status {
    manifest.next_segment = 1;
    return {};
  }));
  flip_bit(store_.path / "segments/000001.h5",
           std::filesystem::file_size(store_.path / "segments/000001.h5") * 4);
  recover();
  EXPECT_EQ(read_manifest(copy_)->segments[0].file, "segments/000004.h5");
}

TEST_F(RecoverTest, CountsWhatAMissingSegmentHeld) {
  std::filesystem::remove(store_.path / "segments/000002.h5");
  const RecoverReport report = recover();
  EXPECT_TRUE(report.has_loss());
  EXPECT_EQ(report.segments_lost, 1u);
  EXPECT_EQ(report.entities.at(FullStore::arm()).recorded_lost, 40u);
  EXPECT_EQ(report.entities.at(FullStore::arm()).unsealed, 10u);
  expect_content(kFullRecorded - 40, kFullLatent);
}

TEST_F(RecoverTest, LosesLatentsWithTheirModel) {
  flip_bit(store_.path / model_file_name(example_entity(), 1), 5);
  const RecoverReport report = recover();
  EXPECT_TRUE(report.has_loss());
  EXPECT_EQ(report.models_lost, 1u);
  EXPECT_EQ(report.entities.at(example_entity()).latent_lost, 30u);
  expect_content(kFullRecorded, 0);
}

TEST_F(RecoverTest, KeepsADamagedModelThatPassesItsTest) {
  flip_bit(store_.path / model_file_name(example_entity(), 1), 5);
  RecoverOptions options;
  options.test_model = [](const std::filesystem::path&) { return Status(); };
  EXPECT_FALSE(recover(options).has_loss());
  expect_content(kFullRecorded, kFullLatent);
}

TEST_F(RecoverTest, WithoutAManifestTestsModels) {
  remove_manifest();
  RecoverOptions options;
  options.test_model = [](const std::filesystem::path&) { return data_loss("decodes nothing"); };
  const RecoverReport report = recover(options);
  EXPECT_EQ(report.models_lost, 1u);
  EXPECT_EQ(report.entities.at(example_entity()).latent_lost, 30u);
  expect_content(kFullRecorded, 0);
}

TEST_F(RecoverTest, SavesWholeFramesOfADamagedJournal) {
  const auto file = store_.path / Journal::file_name(3);
  flip_bit(file, 3);  // Its beginning, and a frame in the middle.
  flip_bit(file, std::filesystem::file_size(file) * 4);
  const RecoverReport report = recover();
  EXPECT_TRUE(report.has_loss());
  EXPECT_EQ(report.damaged_places, 2u);
  EXPECT_EQ(read_manifest(copy_)->damaged, 2u);
  expect_content(kFullRecorded - 1, kFullLatent);
}

TEST_F(RecoverTest, TakesATornTailForWhatItIs) {
  const auto file = store_.path / Journal::file_name(3);
  std::filesystem::remove(acknowledged_mark_of(file));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 50);
  const RecoverReport report = recover();
  EXPECT_FALSE(report.has_loss());
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_THAT(report.findings[0].what, HasSubstr("no whole frame"));
  expect_content(kFullRecorded - 1, kFullLatent);
}

TEST_F(RecoverTest, CountsWhatWasForcedToTheDiskAndIsMissing) {
  const auto file = store_.path / Journal::file_name(3);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 50);
  EXPECT_EQ(recover().damaged_places, 1u);
  EXPECT_EQ(read_manifest(copy_)->damaged, 1u);
  std::filesystem::remove_all(copy_);
  std::filesystem::remove(file);
  const RecoverReport report = recover();
  EXPECT_TRUE(report.has_loss());
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_THAT(report.findings[0].what, HasSubstr("is missing"));
}

TEST_F(RecoverTest, LeavesOutWhatLiesInTheFuture) {
  const auto entity = example_entity();
  Time last{};
  {
    auto reader = *StoreReader::open(store_.path);
    last = (*reader->index(entity))->back().time;
  }
  // The last five are in the journal; some before them are sealed.
  const Time latest = last - (last - example_time(0)) / 4 * 3;
  const auto report = recover_store(store_.path, copy_, {.latest = latest, .test_model = {}});
  ASSERT_OK(report);
  EXPECT_FALSE(report->has_loss());
  auto reader = *StoreReader::open(copy_);
  uint64_t kept = 0;
  for (const SnapshotEntry& entry : **reader->index(entity)) {
    EXPECT_LE(entry.time, latest);
    ++kept;
  }
  EXPECT_GT(kept, 0u);
  auto source = *StoreReader::open(store_.path);
  EXPECT_EQ(kept + report->entities.at(entity).too_late, (*source->index(entity))->size());
  EXPECT_TRUE(check_store(copy_, {true, {}})->is_clean());
}

TEST_F(RecoverTest, IsNeverInPlaceAndOverwritesNothing) {
  EXPECT_FAILS(recover_store(store_.path, store_.path), StatusCode::kInvalidArgument, "lies in");
  EXPECT_FAILS(recover_store(store_.path, store_.path / "inside"), StatusCode::kInvalidArgument,
               "lies in");
  std::filesystem::create_directory(copy_);
  EXPECT_FAILS(recover_store(store_.path, copy_), StatusCode::kAlreadyExists, "there already");
  std::filesystem::remove(copy_);
  std::filesystem::create_directory(scratch_ / "copy.unfinished");
  EXPECT_FAILS(recover_store(store_.path, copy_), StatusCode::kAlreadyExists, "killed");
  std::filesystem::remove(scratch_ / "copy.unfinished");
  EXPECT_FAILS(recover_store(scratch_ / "none", copy_), StatusCode::kNotFound, "does not exist");
  EXPECT_FAILS(recover_store(scratch_.path(), scratch_ / "../copy2"), StatusCode::kNotFound,
               "no store");
}

TEST_F(RecoverTest, RefusesAStoreThatIsWritten) {
  const auto writer = StoreWriter::open(store_.path, {});
  ASSERT_OK(writer);
  EXPECT_FAILS(recover_store(store_.path, copy_), StatusCode::kFailedPrecondition, "is writing");
}

TEST_F(RecoverTest, LeavesNothingWhereItIsStopped) {
  std::stop_source stop;
  const auto stop_soon = [&stop](const Progress& progress) {
    if (progress.done > 0) stop.request_stop();
  };
  EXPECT_FAILS(recover_store(store_.path, copy_, {}, stop_soon, stop.get_token()),
               StatusCode::kCancelled, "stopped");
  EXPECT_FALSE(std::filesystem::exists(copy_));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "copy.unfinished"));
}

TEST_F(RecoverTest, ThatIsKilledLeavesTheSourceAndNoTarget) {
  const auto before = files_of(store_.path);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto die = [](const Progress& progress) {
      if (progress.detail == "segments/000002.h5") ::kill(::getpid(), SIGKILL);
    };
    (void)recover_store(store_.path, copy_, {}, die);
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(files_of(store_.path), before);
  EXPECT_FALSE(std::filesystem::exists(copy_));
  EXPECT_FAILS(recover_store(store_.path, copy_), StatusCode::kAlreadyExists, "copy.unfinished");
  std::filesystem::remove_all(scratch_ / "copy.unfinished");
  recover();
  expect_content(kFullRecorded, kFullLatent);
}

TEST_F(RecoverTest, WithoutAManifestTellsOfUnreadableSegments) {
  remove_manifest();
  std::ofstream(store_.path / "segments/000002.h5") << "nothing";
  const RecoverReport report = recover();
  EXPECT_TRUE(report.has_loss());
  EXPECT_EQ(report.segments_lost, 1u);
  expect_content(kFullRecorded - 40, kFullLatent);
}

TEST_F(RecoverTest, WithoutAManifestSalvagesDamagedSegments) {
  remove_manifest();
  flip_bit(store_.path / "segments/000001.h5",
           std::filesystem::file_size(store_.path / "segments/000001.h5") * 4);
  const RecoverReport report = recover();
  const RecoveredEntity& cam = report.entities.at(example_entity());
  EXPECT_EQ(cam.recorded + cam.recorded_lost, 40u);
  EXPECT_GT(cam.recorded_lost, 0u);
  expect_content(kFullRecorded - cam.recorded_lost, kFullLatent);
}

TEST_F(RecoverTest, IsThereOnlyOnceItIsWhole) {
  const auto look = [this](const Progress&) { EXPECT_FALSE(std::filesystem::exists(copy_)); };
  EXPECT_OK(recover_store(store_.path, copy_ / "", {}, look));
  EXPECT_TRUE(std::filesystem::exists(copy_ / "MANIFEST.json"));
}

}  // namespace
}  // namespace engram::ltm
