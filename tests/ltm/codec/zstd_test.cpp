// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

using Bytes = std::vector<std::byte>;

TEST(Zstd, GivesBackTheBytes) {
  RandomValues random(17);
  for (const size_t size : {0, 1, 100, 100'000}) {
    Bytes bytes(size);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits());
    for (const int level : {1, 3, 12}) {
      const auto plain = decompress_zstd(compress_zstd(bytes, level), size);
      ASSERT_OK(plain);
      EXPECT_EQ(*plain, bytes);
    }
  }
}

TEST(Zstd, ExpandsWhatCompressesBest) {
  const Bytes zeros(50 << 20);
  const Bytes packed = compress_zstd(zeros);
  EXPECT_LT(packed.size(), 5000u);
  const auto plain = decompress_zstd(packed, zeros.size());
  ASSERT_OK(plain);
  EXPECT_EQ(plain->size(), zeros.size());
}

TEST(Zstd, FillsExactlyWhatWasAskedFor) {
  const Bytes plain(1000, std::byte{7});
  const Bytes packed = compress_zstd(plain);
  Bytes exact(1000), less(999), more(1001);
  EXPECT_OK(decompress_zstd(packed, std::span(exact)));
  EXPECT_EQ(exact, plain);
  EXPECT_FAILS(decompress_zstd(packed, std::span(less)), StatusCode::kDataLoss, "zstd frame");
  EXPECT_FAILS(decompress_zstd(packed, std::span(more)), StatusCode::kDataLoss, "has 1000 bytes");
}

TEST(Zstd, AppendsResidualsBehindWhatIsThere) {
  RandomValues random(18);
  Bytes small(50'000);
  for (std::byte& byte : small) byte = static_cast<std::byte>(random.below(8));
  // Noise of eight values takes three bits each; a repeated one next to nothing.
  for (const Bytes& plain : {small, Bytes(50'000, std::byte{3})}) {
    Bytes out{std::byte{1}, std::byte{2}};
    append_residuals(plain, out);
    EXPECT_LT(out.size(), plain == small ? 20'000u : 100u);
    EXPECT_EQ(out[1], std::byte{2});
    const auto back = decompress_zstd(std::span(out).subspan(2), plain.size());
    ASSERT_OK(back);
    EXPECT_EQ(*back, plain);
  }
}

TEST(Zstd, RefusesWhatIsTooLarge) {
  const Bytes packed = compress_zstd(Bytes(1000));
  EXPECT_FAILS(decompress_zstd(packed, 999), StatusCode::kDataLoss, "announces 1000");
}

TEST(Zstd, RefusesAFrameThatAnnouncesMoreThanItCanHold) {
  // Magic, single segment with a content size of 8 bytes: 2^40.
  Bytes hostile;
  for (const int byte : {0x28, 0xb5, 0x2f, 0xfd, 0xe0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0})
    hostile.push_back(static_cast<std::byte>(byte));
  EXPECT_FAILS(decompress_zstd(hostile, SIZE_MAX), StatusCode::kDataLoss, "more than it can hold");
}

TEST(Zstd, RefusesWhatIsNoFrame) {
  EXPECT_FAILS(decompress_zstd({}, 10), StatusCode::kDataLoss, "no zstd frame");
  EXPECT_FAILS(decompress_zstd(Bytes(20), 10), StatusCode::kDataLoss, "no zstd frame");
}

}  // namespace
}  // namespace engram::ltm
