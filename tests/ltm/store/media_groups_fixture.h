// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "ltm/store/store_check.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/codec/test_images.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

inline constexpr int64_t kPictureHeight = 24, kPictureWidth = 32;

inline PackOptions group_options(const std::string& codec) {
  return {.rules = {{.kind = MediumKind::kImage, .codec = codec},
                    {.kind = MediumKind::kNumber, .codec = "columns"}}};
}

inline idf::NdArray picture(int64_t index, int64_t side = 0) {
  return smooth_image(kPictureHeight, kPictureWidth, 3, static_cast<int>(index * 3 + side * 40));
}

/// A store in which pictures are sealed as groups.
class MediaGroupsFixture : public ::testing::Test {
 protected:
  MediaGroupsFixture() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  static Snapshot snapshot(int64_t index, const idf::Data& image) {
    const idf::Dict value{{"image", image},
                          {"x", 0.5 * static_cast<double>(index)},
                          {"label", "number " + std::to_string(index)}};
    return {example_entity(), example_time(index), {{value, example_metadata(index)}}};
  }

  static PackedSnapshot packed(const Snapshot& snapshot, const PackOptions& options) {
    PackedSnapshot made{snapshot.entity, snapshot.time, {}, snapshot.raw_bytes(), 0, 0};
    for (const Instance& instance : snapshot.instances)
      made.instances.push_back({*pack(instance.data, options), instance.metadata});
    return made;
  }

  std::unique_ptr<StoreWriter> writer(const PackOptions& options) {
    StoreWriter::Options writing;
    writing.seal_rules = [rules = *SealRules::create(options)](const MemoryId&) { return rules; };
    return *StoreWriter::open(store_, writing);
  }

  void seal(const std::vector<Snapshot>& snapshots, const std::string& codec) {
    const auto writing = writer(group_options(codec));
    for (const Snapshot& each : snapshots)
      ASSERT_OK(writing->append({packed(each, group_options(codec))}, nullptr));
    ASSERT_OK(writing->seal());
  }

  void seal_pictures(int64_t first, int64_t end, const std::string& codec) {
    std::vector<Snapshot> snapshots;
    for (int64_t i = first; i < end; ++i) snapshots.push_back(snapshot(i, picture(i)));
    seal(snapshots, codec);
  }

  std::vector<Snapshot> read() {
    const auto reader = *StoreReader::open(store_);
    auto found = read_all(*reader, example_entity());
    EXPECT_OK(found);
    return found.ok() ? *std::move(found) : std::vector<Snapshot>();
  }

  void expect_content(const std::vector<Snapshot>& expected) {
    const auto found = read();
    ASSERT_EQ(found.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(found[i], expected[i]) << i;
  }

  /// The first medium of each snapshot, as it is stored.
  std::vector<PackedMedium> media() {
    const auto reader = *StoreReader::open(store_);
    std::vector<PackedMedium> found;
    for (const SnapshotEntry& entry : **reader->index(example_entity())) {
      const PackedSnapshot packed = *reader->read_packed(example_entity(), entry);
      for (const PackedMedium& medium : packed.instances[0].value.media) found.push_back(medium);
    }
    return found;
  }

  std::vector<std::string> codecs() {
    std::vector<std::string> names;
    for (const PackedMedium& medium : media())
      names.push_back(medium.group ? fmt::format("{} {}/{}", medium.codec, medium.group->index,
                                                 medium.group->count)
                                   : medium.codec);
    return names;
  }

  void expect_clean(const std::filesystem::path& store) {
    const auto report = check_store(store, {true, {}});
    ASSERT_OK(report);
    for (const Finding& finding : report->findings)
      ADD_FAILURE() << finding.file << ": " << finding.object << ": " << finding.what;
  }

  std::filesystem::path segment_file() {
    return store_ / read_manifest(store_)->segments.back().file;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

}  // namespace engram::ltm
