// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_value_reader.h"

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/store/segment_source.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

/// Reads an entity whose file has layout and times, and nothing of what the layout names.
Status read_without_tables(const std::filesystem::path& path, const idf::Data& value) {
  const auto layout =
      *idf::encode(idf::Layout::of(value).to_data(), idf::kMaxDepth + idf::kContainerDepth);
  const uint64_t size = layout.size(), rows = 1;
  auto file = *h5::File::create(path);
  EXPECT_OK(file.make_group("/e"));
  EXPECT_OK(
      file.write("/e/layout", h5::Type::kUInt8, {&size, 1}, layout, h5::Storage::kCompressed));
  const int64_t time = 1;
  EXPECT_OK(file.write("/e/timestamp", h5::Type::kInt64, {&rows, 1},
                       std::as_bytes(std::span(&time, 1)), h5::Storage::kCompressed));
  EXPECT_OK(file.close());
  SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
  return SegmentValueReader(source).columns("/e").status();
}

TEST(SegmentValueReader, CallsAMissingDatasetDataLoss) {
  const ScratchDirectory scratch;
  const auto array = idf::NdArray::take<float>({2, 3}, std::vector<float>(6, 1.0f));
  EXPECT_FAILS(read_without_tables(scratch / "array.h5", idf::Dict{{"force", array}}),
               StatusCode::kDataLoss, "'/e/arrays/force': is missing");
  EXPECT_FAILS(read_without_tables(scratch / "number.h5", idf::Dict{{"x", 1.0}}),
               StatusCode::kDataLoss, "'/e/columns/float64/values': is missing");
}

}  // namespace
}  // namespace engram::ltm
