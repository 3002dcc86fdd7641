// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/checksum.h"

#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

TEST(Checksum, IsXxh3) {
  // Part of the format: the value of the empty input by the specification of XXH3.
  EXPECT_EQ(checksum({}), 0x2d06800538d394c2u);
}

TEST(Checksum, OfAFileReadInPiecesIsThatOfItsBytes) {
  const ScratchDirectory scratch;
  for (const size_t size : {size_t{0}, size_t{1}, size_t{1} << 20, (size_t{5} << 19) + 3}) {
    std::vector<std::byte> bytes(size);
    for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 31 >> 3);
    ASSERT_OK(replace_file(scratch / "file", bytes));
    const auto found = checksum_of_file(scratch / "file");
    ASSERT_OK(found);
    EXPECT_EQ(*found, checksum(bytes)) << size;
  }
  EXPECT_FAILS(checksum_of_file(scratch / "none"), StatusCode::kNotFound, "none");
}

}  // namespace
}  // namespace engram::ltm
