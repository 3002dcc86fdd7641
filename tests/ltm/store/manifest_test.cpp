// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/manifest.h"

#include <nlohmann/json.hpp>
#include <thread>

#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

using Json = nlohmann::ordered_json;

class ManifestTest : public ::testing::Test {
 protected:
  ManifestTest() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  Json read_json() { return Json::parse(as_text(read_file(store_ / "MANIFEST.json")->bytes())); }
  void write_text(const std::string& text) {
    overwrite_file(store_ / "MANIFEST.json", as_bytes(text));
  }

  static SegmentInfo example_segment() {
    SegmentEntity entity{
        example_entity("a/b \\ ü"), 10, 20, example_time(0), example_time(9), 1000, 500, 3, 90, {}};
    entity.latent = {2, 20, 640.25, 1.5, 19, 0.125};
    return {"segments/000001.h5", SegmentKind::kLatent, 1234, 0xfedcba9876543210u, 7, {entity}};
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(ManifestTest, OfANewStoreIsEmpty) {
  const auto manifest = read_manifest(store_);
  ASSERT_OK(manifest);
  EXPECT_EQ(manifest->store_id.size(), 16u);
  EXPECT_TRUE(manifest->segments.empty());
  EXPECT_TRUE(manifest->models.empty());
  EXPECT_EQ(manifest->next_segment, 1u);
  EXPECT_EQ(manifest->first_journal, 1u);
}

TEST_F(ManifestTest, GivesBackWhatWasWritten) {
  const SegmentInfo segment = example_segment();
  const ModelInfo model{segment.entities[0].id, 2, "models/m.h5", 77, 0xffffffffffffffffu};
  ASSERT_OK(edit_manifest(store_, [&](Manifest& manifest) -> Status {
    manifest.segments.push_back(segment);
    manifest.models.push_back(model);
    manifest.damaged = 4;
    manifest.first_journal = 8;
    manifest.next_segment = 2;
    return {};
  }));
  const auto read = read_manifest(store_);
  ASSERT_OK(read);
  EXPECT_EQ(read->damaged, 4u);
  EXPECT_EQ(read->first_journal, 8u);
  EXPECT_EQ(read->next_segment, 2u);
  ASSERT_EQ(read->segments.size(), 1u);
  EXPECT_EQ(read->segments[0].kind, SegmentKind::kLatent);
  EXPECT_EQ(read->segments[0].checksum, segment.checksum);
  EXPECT_EQ(read->segments[0].last_journal, segment.last_journal);
  EXPECT_EQ(read->segments[0].bytes, segment.bytes);
  ASSERT_EQ(read->segments[0].entities.size(), 1u);
  const SegmentEntity& entity = read->segments[0].entities[0];
  EXPECT_EQ(entity.id, segment.entities[0].id);
  EXPECT_EQ(entity.rows, 20u);
  EXPECT_EQ(entity.first, example_time(0));
  EXPECT_EQ(entity.last, example_time(9));
  EXPECT_EQ(entity.dropped_bytes, 90u);
  EXPECT_EQ(entity.latent.psnr_db, 640.25);
  EXPECT_EQ(entity.latent.number_rows, 19u);
  ASSERT_EQ(read->models.size(), 1u);
  EXPECT_EQ(read->models[0].checksum, model.checksum);
  EXPECT_EQ(read->models[0].name(), "Vision/RGB/head/a\\/b \\\\ ü v2");
}

TEST_F(ManifestTest, RefusesANewerFormat) {
  Json json = read_json();
  json["format_version"] = 4;
  json.erase("segments");
  write_text(json.dump());
  EXPECT_FAILS(read_manifest(store_), StatusCode::kFailedPrecondition, "reads up to 3");
}

TEST_F(ManifestTest, TellsItsGenerationAlone) {
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(read_generation(store_).value_or(99), read_manifest(store_)->generation);
    ASSERT_OK(edit_manifest(store_, [](Manifest&) { return Status(); }));
  }
  // As another program would write it.
  Json json = read_json();
  json.erase("checksum");
  write_text(json.dump());
  EXPECT_EQ(read_generation(store_).value_or(99), 12U);
  write_text("{");
  EXPECT_FAILS(read_generation(store_), StatusCode::kDataLoss, "MANIFEST.json");
  std::filesystem::remove(store_ / "MANIFEST.json");
  EXPECT_FALSE(read_generation(store_).ok());
}

TEST_F(ManifestTest, RefusesWhatIsBroken) {
  const std::string whole = read_json().dump();
  for (size_t size = 0; size < whole.size(); ++size) {
    write_text(whole.substr(0, size));
    EXPECT_FAILS(read_manifest(store_), StatusCode::kDataLoss, "MANIFEST.json");
  }
  for (const char* text : {"{}", "[]", "null", R"({"format": "engram store"})",
                           R"({"format": "other", "format_version": 1})"}) {
    write_text(text);
    EXPECT_FAILS(read_manifest(store_), StatusCode::kDataLoss, "MANIFEST.json");
  }
}

TEST_F(ManifestTest, RefusesFilesOutsideOfTheStore) {
  for (const char* file : {"../x.h5", "segments/../../x.h5", "/etc/passwd"}) {
    SegmentInfo segment = example_segment();
    segment.file = file;
    const Buffer before = *read_file(store_ / "MANIFEST.json");
    ASSERT_OK(edit_manifest(store_, [&](Manifest& manifest) -> Status {
      manifest.segments = {segment};
      return {};
    }));
    EXPECT_FAILS(read_manifest(store_), StatusCode::kDataLoss, "outside of the store");
    write_text(std::string(as_text(before.bytes())));
  }
}

TEST_F(ManifestTest, IsRefusedWhereAnyOneBitFlipped) {
  ASSERT_OK(edit_manifest(store_, [](Manifest& manifest) -> Status {
    manifest.segments = {example_segment()};
    return {};
  }));
  const Buffer whole = *read_file(store_ / "MANIFEST.json");
  for (size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string text(as_text(whole.bytes()));
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ (1 << bit % 8));
    write_text(text);
    EXPECT_FALSE(read_manifest(store_).ok()) << "bit " << bit;
  }
}

TEST_F(ManifestTest, OfAnEarlierProgramHasNoChecksum) {
  Json json = read_json();
  json.erase("checksum");
  for (const int indent : {-1, 1}) {
    write_text(json.dump(indent) + "\n");
    EXPECT_OK(read_manifest(store_));
  }
}

TEST_F(ManifestTest, IsNotWrittenWhereTheChangeFails) {
  const auto before = read_manifest(store_);
  const Status status = edit_manifest(store_, [](Manifest& manifest) -> Status {
    manifest.damaged = 99;
    return cancelled("changed my mind");
  });
  EXPECT_FAILS(status, StatusCode::kCancelled, "changed my mind");
  EXPECT_EQ(read_manifest(store_)->generation, before->generation);
  EXPECT_EQ(read_manifest(store_)->damaged, 0u);
}

TEST_F(ManifestTest, LosesNoEditOfTwoThreads) {
  const uint64_t before = read_manifest(store_)->generation;
  const auto edit_often = [this] {
    for (int i = 0; i < 50; ++i)
      EXPECT_OK(edit_manifest(store_, [](Manifest& manifest) -> Status {
        ++manifest.next_segment;
        return {};
      }));
  };
  { const std::jthread one(edit_often), two(edit_often); }
  EXPECT_EQ(read_manifest(store_)->next_segment, 101u);
  EXPECT_EQ(read_manifest(store_)->generation, before + 100);
}

TEST_F(ManifestTest, OfAStoreIsNotMadeTwice) {
  EXPECT_FAILS(create_store(store_), StatusCode::kAlreadyExists, "no empty directory");
  EXPECT_FAILS(read_manifest(scratch_ / "none"), StatusCode::kNotFound, "does not exist");
  EXPECT_FAILS(read_manifest(scratch_.path()), StatusCode::kNotFound, "is no store");
  EXPECT_FAILS(edit_manifest(scratch_.path(), [](Manifest&) { return Status(); }),
               StatusCode::kNotFound, "is no store");
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "MANIFEST.lock"));
}

TEST(CreateStore, GoesOnWhereAKilledOneStopped) {
  const ScratchDirectory scratch;
  const auto store = scratch / "store";
  std::filesystem::create_directories(store / "journal");
  std::filesystem::create_directories(store / "segments");
  std::ofstream(store / "MANIFEST.json.new") << "{";
  EXPECT_TRUE(is_store_absent(store));
  EXPECT_OK(create_store(store));
  EXPECT_FALSE(is_store_absent(store));
}

TEST(CreateStore, LeavesWhatIsNotItsOwnAlone) {
  const ScratchDirectory scratch;
  const auto store = scratch / "store";
  std::filesystem::create_directories(store / "journal");
  std::ofstream(store / "journal/diary.txt") << "mine";
  EXPECT_FALSE(is_store_absent(store));
  EXPECT_FAILS(create_store(store), StatusCode::kAlreadyExists, "no empty directory");
}

}  // namespace
}  // namespace engram::ltm
