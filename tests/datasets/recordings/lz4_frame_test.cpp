// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/lz4_frame.h"

#include <vector>

#include "ltm/core/buffer.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets {
namespace {

/// Of several blocks.
std::string long_text() {
  std::string text;
  for (int i = 0; i < 40'000; ++i) text += std::to_string(i * 7919);
  return text;
}

TEST(Lz4Frame, ComesBackWithAnyOption) {
  const std::string text = long_text();
  for (const Lz4FrameOptions options :
       {Lz4FrameOptions{}, Lz4FrameOptions{.has_independent_blocks = true},
        Lz4FrameOptions{.has_independent_blocks = true, .has_checksum = true}}) {
    const auto frame = compress_lz4(as_bytes(text), options);
    ASSERT_OK(frame);
    std::string out(text.size(), '\0');
    ASSERT_OK(decompress_lz4(as_bytes(*frame), std::as_writable_bytes(std::span(out))));
    EXPECT_EQ(out, text);
  }
}

// roslz4 of ROS 1 reads frames of version 1 with exactly these two flags.
TEST(Lz4Frame, SaysWhatItHas) {
  const auto frame =
      compress_lz4(as_bytes(long_text()), {.has_independent_blocks = true, .has_checksum = true});
  ASSERT_OK(frame);
  EXPECT_EQ(frame->at(4), '\x64');
}

TEST(Lz4Frame, SeesAChangedByteWhereItHasAChecksum) {
  const std::string text = long_text();
  auto frame = compress_lz4(as_bytes(text), {.has_independent_blocks = true, .has_checksum = true});
  ASSERT_OK(frame);
  frame->at(20) ^= 1;  // Of the first text, that is not compressed.
  std::string out(text.size(), '\0');
  EXPECT_FAILS(decompress_lz4(as_bytes(*frame), std::as_writable_bytes(std::span(out))),
               StatusCode::kDataLoss, "lz4 frame");
}

}  // namespace
}  // namespace engram::datasets
