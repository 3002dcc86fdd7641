// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_index.h"

#include "ltm/core/file.h"
#include "ltm/store/orphans.h"
#include "ltm/store/recover.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

class SegmentIndexTest : public ::testing::Test {
 protected:
  SegmentIndexTest() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  void seal(int64_t first, int64_t end) {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = first; i < end; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
    ASSERT_OK(writer->seal());
  }

  [[nodiscard]] SegmentInfo segment(size_t index = 0) const {
    return read_manifest(store_)->segments.at(index);
  }

  Status put(const SegmentInfo& segment, const std::string& text) {
    return edit_segment_index(store_, segment, "codes", [&text](auto) {
      const auto bytes = as_bytes(text);
      return std::vector(bytes.begin(), bytes.end());
    });
  }

  std::string get(const SegmentInfo& segment) {
    const auto content = read_segment_index(store_, segment, "codes");
    return content.ok() ? std::string(as_text(content->bytes())) : content.status().to_string();
  }

  [[nodiscard]] std::filesystem::path file(const SegmentInfo& segment) const {
    return store_ / segment_index_name(segment.file, "codes");
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(SegmentIndexTest, IsReadAsItWasWritten) {
  seal(0, 3);
  ASSERT_OK(put(segment(), "what is where"));
  EXPECT_EQ(get(segment()), "what is where");
  EXPECT_EQ(segment_index_name("segments/000012.h5", "codes"), "indexes/000012.codes");
  EXPECT_EQ(entity_index_name(example_entity(), "space"), "indexes/Vision.RGB.head.cam.space");
}

TEST_F(SegmentIndexTest, IsEditedFromWhatIsThere) {
  seal(0, 3);
  ASSERT_OK(put(segment(), "a"));
  ASSERT_OK(edit_segment_index(store_, segment(), "codes", [](std::span<const std::byte> there) {
    std::vector<std::byte> more(there.begin(), there.end());
    more.push_back(std::byte{'b'});
    return more;
  }));
  EXPECT_EQ(get(segment()), "ab");
}

TEST_F(SegmentIndexTest, IsNotReadWhereAnyByteIsDamaged) {
  seal(0, 3);
  ASSERT_OK(put(segment(), "what is where"));
  const Buffer whole = *read_file(file(segment()));
  for (size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::byte> bytes(whole.bytes().begin(), whole.bytes().end());
    bytes[i] ^= std::byte{4};
    overwrite_file(file(segment()), bytes);
    EXPECT_EQ(read_segment_index(store_, segment(), "codes").status().code(),
              StatusCode::kDataLoss);
  }
  for (size_t size = 0; size < whole.size(); ++size) {
    overwrite_file(file(segment()), whole.bytes().first(size));
    EXPECT_EQ(read_segment_index(store_, segment(), "codes").status().code(),
              StatusCode::kDataLoss);
  }
}

TEST_F(SegmentIndexTest, GoesWithItsSegment) {
  seal(0, 3);
  seal(3, 6);
  const SegmentInfo first = segment(0), second = segment(1);
  ASSERT_OK(put(first, "first"));
  ASSERT_OK(put(second, "second"));
  ForgetSet gone;
  gone[example_entity()].insert(example_time(1));
  ASSERT_OK(forget_snapshots(store_, gone));
  EXPECT_FALSE(std::filesystem::exists(file(first)));
  EXPECT_EQ(get(second), "second");
  ASSERT_OK(compact(store_, {}));
  EXPECT_TRUE(std::filesystem::is_empty(store_ / kIndexFolder));
}

TEST_F(SegmentIndexTest, IsNotWrittenForASegmentThatIsGone) {
  seal(0, 3);
  const SegmentInfo before = segment();
  ForgetSet gone;
  gone[example_entity()].insert(example_time(1));
  ASSERT_OK(forget_snapshots(store_, gone));
  EXPECT_FAILS(put(before, "what was forgotten"), StatusCode::kNotFound, "is there no more");
  EXPECT_FALSE(std::filesystem::exists(file(before)));
}

TEST_F(SegmentIndexTest, OfAnEntityIsRefusedOnceSnapshotsWereForgotten) {
  seal(0, 3);
  const Manifest before = *read_manifest(store_);
  ASSERT_OK(publish_entity_index(store_, before, example_entity(), "space", as_bytes("learned")));
  EXPECT_EQ(as_text(read_entity_index(store_, example_entity(), "space")->bytes()), "learned");
  ForgetSet gone;
  gone[example_entity()].insert(example_time(1));
  ASSERT_OK(forget_snapshots(store_, gone));
  EXPECT_FAILS(publish_entity_index(store_, before, example_entity(), "space", as_bytes("old")),
               StatusCode::kFailedPrecondition, "were forgotten meanwhile");
  EXPECT_OK(read_entity_index(store_, example_entity(), "space"));  // As models, it stays.
  EXPECT_EQ(remove_outdated_entity_indexes(store_)->size(), 1u);
  EXPECT_FAILS(read_entity_index(store_, example_entity(), "space"), StatusCode::kNotFound, "");
  const Manifest after = *read_manifest(store_);
  ASSERT_OK(publish_entity_index(store_, after, example_entity(), "space", as_bytes("anew")));
  EXPECT_TRUE(remove_outdated_entity_indexes(store_)->empty());
  EXPECT_EQ(remove_entity_indexes(store_, example_entity())->size(), 1u);
  EXPECT_FAILS(read_entity_index(store_, example_entity(), "space"), StatusCode::kNotFound, "");
}

TEST_F(SegmentIndexTest, OfAnotherSegmentFileOfThatNameDoesNotCount) {
  seal(0, 3);
  ASSERT_OK(put(segment(), "what is where"));
  SegmentInfo other = segment();
  ++other.checksum;
  EXPECT_FAILS(read_segment_index(store_, other, "codes"), StatusCode::kNotFound,
               "earlier segment");
}

TEST_F(SegmentIndexTest, IsCheckedAndLeftoversAreRemovedByTheNextWriter) {
  seal(0, 3);
  ASSERT_OK(put(segment(), "what is where"));
  overwrite_file(store_ / kIndexFolder / "000099.codes", as_bytes("of a segment that is gone"));
  overwrite_file(store_ / kIndexFolder / "000001.codes.new", as_bytes("not finished"));
  EXPECT_EQ(find_orphans(store_)->size(), 2u);
  std::vector<std::byte> bytes(30);
  overwrite_file(file(segment()), bytes);
  const auto report = check_store(store_);
  ASSERT_OK(report);
  EXPECT_TRUE(report->is_clean());  // Nothing is lost.
  EXPECT_TRUE(std::ranges::any_of(report->findings, [](const Finding& one) {
    return one.what.find("damaged index") != std::string::npos;
  }));
  seal(3, 4);
  EXPECT_TRUE(find_orphans(store_)->empty());
}

TEST_F(SegmentIndexTest, IsRecoveredWithItsSegment) {
  seal(0, 3);
  seal(3, 6);
  ASSERT_OK(put(segment(0), "first"));
  ASSERT_OK(put(segment(1), "second"));
  const Manifest manifest = *read_manifest(store_);
  ASSERT_OK(publish_entity_index(store_, manifest, example_entity(), "space", as_bytes("learned")));
  const SegmentInfo whole = segment(0), damaged = segment(1);
  std::filesystem::resize_file(store_ / damaged.file, damaged.bytes / 2);
  ASSERT_OK(recover_store(store_, scratch_ / "copy"));
  store_ = scratch_ / "copy";
  EXPECT_EQ(get(whole), "first");
  EXPECT_FALSE(std::filesystem::exists(file(damaged)));
  EXPECT_EQ(as_text(read_entity_index(store_, example_entity(), "space")->bytes()), "learned");
}

}  // namespace
}  // namespace engram::ltm
