// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_check.h"

#include <atomic>
#include <fstream>
#include <thread>

#include "ltm/store/journal.h"
#include "ltm/store/rewrite.h"
#include "tests/ltm/store/full_store.h"

namespace engram::ltm {
namespace {

using ::testing::HasSubstr;

class CheckTest : public ::testing::Test {
 protected:
  CheckTest() : store_(FullStore::make(scratch_ / "store")) {}

  CheckReport check(const CheckOptions& options = {}) {
    const auto report = check_store(store_.path, options);
    EXPECT_OK(report);
    return report.value_or(CheckReport());
  }

  /// The faults about a file, or the notes.
  static std::vector<Finding> findings(const CheckReport& report, const std::string& file,
                                       Severity severity = Severity::kFault) {
    std::vector<Finding> found;
    for (const Finding& finding : report.findings)
      if (finding.file == file && finding.severity == severity) found.push_back(finding);
    return found;
  }

  void expect_fault(const std::string& file, const std::string& what) {
    const auto faults = findings(check(), file);
    ASSERT_FALSE(faults.empty()) << file;
    EXPECT_THAT(faults[0].what, HasSubstr(what));
    EXPECT_THAT(faults[0].advice, HasSubstr("recover"));
  }

  Status edit(const std::function<void(Manifest&)>& change) {
    return edit_manifest(store_.path, [&](Manifest& manifest) -> Status {
      change(manifest);
      return {};
    });
  }

  [[nodiscard]] std::string model_file() const { return model_file_name(example_entity(), 1); }

  ScratchDirectory scratch_;
  FullStore store_;
};

TEST_F(CheckTest, OfAWholeStoreIsCleanAndCountsEverything) {
  const CheckReport report = check({true, {}});
  EXPECT_TRUE(report.is_clean());
  EXPECT_EQ(report.segments, 3u);
  EXPECT_EQ(report.models, 1u);
  EXPECT_EQ(report.journals, 1u);
  EXPECT_EQ(report.frames, 20u);
  EXPECT_EQ(report.entities, 2u);
  EXPECT_EQ(report.snapshots, 110u);
  EXPECT_EQ(report.instances, 124u);
  EXPECT_EQ(report.media, 94u);
  EXPECT_GT(report.bytes, 10'000u);
}

TEST_F(CheckTest, NotesLinksThatLeadOutOfTheStore) {
  const CheckReport report = check();
  ASSERT_EQ(report.findings.size(), 1u);
  EXPECT_EQ(report.findings[0].severity, Severity::kNote);
  // Every fourth of 50; links to "arm" lead somewhere.
  EXPECT_THAT(report.findings[0].what, HasSubstr("13 links lead to 'Body/Hand/left/palm'"));
}

TEST_F(CheckTest, FindsMissingFiles) {
  std::filesystem::remove(store_.path / "segments/000001.h5");
  std::filesystem::remove(store_.path / model_file());
  expect_fault("segments/000001.h5", "cannot be read");
  expect_fault(model_file(), "cannot be read");
}

TEST_F(CheckTest, FindsCutAndDamagedFiles) {
  std::filesystem::resize_file(store_.path / "segments/000001.h5", 5000);
  flip_bit(store_.path / "segments/000002.h5", 8 * 3000);
  flip_bit(store_.path / model_file(), 77);
  expect_fault("segments/000001.h5", "has 5000 bytes, the manifest says");
  expect_fault("segments/000002.h5", "fails its checksum");
  expect_fault(model_file(), "fails its checksum");
}

TEST_F(CheckTest, NamesTheSnapshotThatIsDamaged) {
  // The blobs are the bulk of the file: one medium, or more, is hit.
  const auto size = std::filesystem::file_size(store_.path / "segments/000001.h5");
  for (uint64_t at = size / 4; at < size / 4 * 3; at += 500)
    flip_bit(store_.path / "segments/000001.h5", at * 8);
  const auto faults = findings(check(), "segments/000001.h5");
  ASSERT_GE(faults.size(), 2u);
  EXPECT_LE(faults.size(), 20u);
  EXPECT_TRUE(std::ranges::any_of(faults, [](const Finding& f) {
    return f.object.starts_with(example_entity().to_string() + "/2020");
  }));
}

TEST_F(CheckTest, FindsWhatTheManifestTellsWrong) {
  ASSERT_OK(edit([](Manifest& m) { m.segments[0].entities.edit()[0].snapshots = 39; }));
  expect_fault("segments/000001.h5", "the manifest says 39");
  ASSERT_OK(edit([](Manifest& m) {
    m.segments[0].entities.edit()[0].snapshots = 40;
    m.segments[0].entities.edit()[0].last += Duration(1);
  }));
  expect_fault("segments/000001.h5", "the manifest says from");
  ASSERT_OK(edit([](Manifest& m) { m.segments[0].entities.edit()[0].id = example_entity("eye"); }));
  EXPECT_EQ(findings(check(), "segments/000001.h5").size(), 3u);
  ASSERT_OK(edit([](Manifest& m) {
    m.segments[0].entities.edit()[0].id = example_entity();
    m.segments[0].kind = SegmentKind::kLatent;
  }));
  expect_fault("segments/000001.h5", "another kind");
  ASSERT_OK(edit([](Manifest& m) { m.next_segment = 2; }));
  expect_fault("MANIFEST.json", "would take its place");
}

TEST_F(CheckTest, FindsLatentsWithoutAModel) {
  ASSERT_OK(edit([](Manifest& m) { m.models.clear(); }));
  expect_fault("segments/000003.h5", "a model that is not there");
}

TEST_F(CheckTest, TestsModelsWhereItCan) {
  CheckOptions options;
  options.test_model = [](const std::filesystem::path& file) {
    return data_loss("model '{}': decodes otherwise than it did", file.filename().string());
  };
  const auto faults = findings(check(options), model_file());
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].object, "Vision/RGB/head/cam v1");
  EXPECT_THAT(faults[0].what, HasSubstr("decodes otherwise"));
}

TEST_F(CheckTest, TellsATornTailFromDamage) {
  const std::string file = Journal::file_name(3).string();
  ASSERT_TRUE(std::filesystem::exists(store_.path / file));
  const auto size = std::filesystem::file_size(store_.path / file);
  const Buffer whole = *read_file(store_.path / file);
  // It was forced to the disk, and that was noted.
  std::filesystem::resize_file(store_.path / file, size - 100);
  expect_fault(file, "bytes were forced to the disk: the last");
  std::filesystem::remove(store_.path / file);
  expect_fault(file, "is missing");
  overwrite_file(store_.path / file, whole.bytes());
  EXPECT_TRUE(check().is_clean());

  std::filesystem::remove(acknowledged_mark_of(store_.path / file));
  std::filesystem::resize_file(store_.path / file, size - 100);
  const CheckReport torn = check();
  EXPECT_TRUE(torn.is_clean());
  EXPECT_EQ(torn.unknown_ends, 1u);
  ASSERT_EQ(findings(torn, file, Severity::kNote).size(), 1u);
  EXPECT_THAT(findings(torn, file, Severity::kNote)[0].what, HasSubstr("no whole frame"));
  overwrite_file(store_.path / file, whole.bytes());
  flip_bit(store_.path / file, (size - 100) * 8);
  expect_fault(file, "fails its checksum: damage, or a torn append");
  overwrite_file(store_.path / file, whole.bytes());
  flip_bit(store_.path / file, size / 2 * 8);
  expect_fault(file, "1 places are damaged");
}

TEST_F(CheckTest, NotesWhatIsLeftOver) {
  for (const char* name : {"segments/000099.h5", "models/old.h5", "tmp/999999999-0.h5",
                           "journal/000001.log", "journal/000001.log.damaged"})
    std::ofstream(store_.path / name) << "x";
  const CheckReport report = check();
  EXPECT_TRUE(report.is_clean());
  for (const char* name : {"segments/000099.h5", "models/old.h5", "tmp/999999999-0.h5",
                           "journal/000001.log", "journal/000001.log.damaged"})
    EXPECT_EQ(findings(report, name, Severity::kNote).size(), 1u) << name;
}

TEST_F(CheckTest, OfABrokenManifestIsAFault) {
  flip_bit(store_.path / "MANIFEST.json", 1000);
  expect_fault("MANIFEST.json", "broken");
  std::filesystem::remove(store_.path / "MANIFEST.json");
  expect_fault("MANIFEST.json", "no store");
}

TEST_F(CheckTest, FailsWhereThereIsNoStore) {
  EXPECT_FAILS(check_store(scratch_ / "none"), StatusCode::kNotFound, "does not exist");
  EXPECT_FAILS(check_store(scratch_.path()), StatusCode::kNotFound, "is no store");
}

TEST_F(CheckTest, StopsWhenAskedTo) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(check_store(store_.path, {}, {}, stop.get_token()), StatusCode::kCancelled,
               "stopped");
}

TEST_F(CheckTest, TellsItsProgressInBytes) {
  std::vector<Progress> told;
  ASSERT_OK(check_store(store_.path, {}, [&told](const Progress& p) { told.push_back(p); }));
  ASSERT_EQ(told.size(), 5u);
  EXPECT_EQ(told[0].done, 0u);
  EXPECT_GT(told[4].done, told[0].done);
  EXPECT_LT(told[4].done, told[4].total);
}

TEST(Check, RaisesNoFalseAlarmBesideALiveWriter) {
  const ScratchDirectory scratch;
  ASSERT_OK(create_store(scratch / "store"));
  std::atomic<bool> is_done = false;
  std::jthread writing([&] {
    const auto writer = *StoreWriter::open(scratch / "store", {});
    for (int64_t i = 0; i < 300; ++i) {
      ASSERT_OK(writer->append({packed_example(i)}, nullptr));
      if (i % 10 == 9) ASSERT_OK(writer->seal());
      if (i % 50 != 49) continue;
      const auto model = *temporary_file(scratch / "store", ".model");
      ASSERT_OK(replace_file(model, as_bytes("weights")));
      const int version = next_model_version(*read_manifest(scratch / "store"), example_entity());
      ASSERT_OK(publish_model(scratch / "store", example_entity(), version, model,
                              example_latents(0, i, version)));
      ASSERT_OK(drop_recorded(scratch / "store", example_entity(), {}));
    }
    is_done = true;
  });
  int checks = 0;
  while (!is_done || checks == 0) {
    const auto report = check_store(scratch / "store");
    ++checks;
    ASSERT_OK(report);
    for (const Finding& finding : report->findings)
      EXPECT_EQ(finding.severity, Severity::kNote)
          << finding.file << " " << finding.object << " " << finding.what;
  }
}

}  // namespace
}  // namespace engram::ltm
