// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_media_reader.h"

#include "ltm/core/file.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/segment_column.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

/// A media group written by hand.
class HostileGroups : public ::testing::Test {
 protected:
  Result<std::vector<PackedMedium>> read(const std::vector<uint64_t>& first_images,
                                         const std::vector<uint64_t>& rows, uint64_t row,
                                         const std::string& shape_of = "one") {
    const auto path = scratch_ / ("s" + std::to_string(++files_) + ".h5");
    auto file = *h5::File::create(path);
    BlobColumn blobs;
    for (size_t i = 1; i < first_images.size(); ++i) blobs.append(as_bytes("bytes of a group"));
    EXPECT_OK(blobs.write(file, "/e/media/image"));
    EXPECT_OK(file.write_attribute("/e/media/image", "path", "image"));
    EXPECT_OK(file.write_attribute("/e/media/image", "codec", "h264"));
    EXPECT_OK(file.write_attribute("/e/media/image", "element_type", "uint8"));
    const std::vector<int64_t> shape{24, 32, 3};
    const std::vector<uint64_t> size{1, 3};
    EXPECT_OK(file.write("/e/media/image/shape", h5::Type::kInt64,
                         shape_of == "one" ? std::vector<uint64_t>{3} : size,
                         std::as_bytes(std::span(shape)), h5::Storage::kCompressed));
    EXPECT_OK(write_column(file, "/e/media/image/first_image", first_images));
    if (!rows.empty()) {
      EXPECT_OK(write_column(file, "/e/media/image/row", rows));
    }
    const std::string name = "/e/media/image";
    EXPECT_OK(file.write_strings("/e/media_groups", {&name, 1}));
    EXPECT_OK(file.close());
    SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
    return SegmentMediaReader(source).media("/e", row);
  }

  ScratchDirectory scratch_;
  int files_ = 0;
};

TEST_F(HostileGroups, AreReadWhereTheyAreValid) {
  const auto found = read({0, 3, 5}, {1, 2, 4, 6, 9}, 6);
  ASSERT_OK(found);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_EQ((*found)[0].group->index, 0u);
  EXPECT_EQ((*found)[0].group->count, 2u);
  EXPECT_TRUE(read({0, 3, 5}, {1, 2, 4, 6, 9}, 3)->empty());
  EXPECT_TRUE(read({0, 3, 5}, {1, 2, 4, 6, 9}, 0)->empty());
  EXPECT_TRUE(read({0, 3, 5}, {1, 2, 4, 6, 9}, 99)->empty());
}

TEST_F(HostileGroups, AreRefusedWhereTheyContradictThemselves) {
  EXPECT_FAILS(read({}, {}, 0), StatusCode::kDataLoss, "needs two rows");
  EXPECT_FAILS(read({0}, {}, 0), StatusCode::kDataLoss, "needs two rows");
  EXPECT_FAILS(read({0, 3}, {}, 3), StatusCode::kDataLoss, "needs one of row 3");
  EXPECT_FAILS(read({0, 3}, {0, 1}, 1), StatusCode::kDataLoss, "needs 3");
  EXPECT_FAILS(read({5, 3, 4}, {}, 1), StatusCode::kDataLoss, "no valid group");
  EXPECT_FAILS(read({0, 9, 4}, {}, 2), StatusCode::kDataLoss, "");
  EXPECT_FAILS(read({0, 5000}, {}, 2), StatusCode::kDataLoss, "no valid group");
  EXPECT_FAILS(read({0, UINT64_MAX}, {}, 2), StatusCode::kDataLoss, "no valid group");
  EXPECT_FAILS(read({0, 3}, {}, 2, "many"), StatusCode::kDataLoss, "one shape");
}

}  // namespace
}  // namespace engram::ltm
