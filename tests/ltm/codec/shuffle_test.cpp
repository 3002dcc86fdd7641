// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/shuffle.h"

#include <vector>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

using Bytes = std::vector<std::byte>;

Bytes of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(Shuffle, LaysEqualPlacesOfRecordsTogether) {
  const Bytes in = of({1, 2, 3, 11, 12, 13, 99});
  Bytes out(in.size());
  shuffle_bytes(in, 3, out);
  EXPECT_EQ(out, of({1, 11, 2, 12, 3, 13, 99}));
}

TEST(Shuffle, LaysEqualBitsOfRecordsTogether) {
  // Bit 0 of the second of eight records, bit 7 of the first.
  const Bytes in = of({0x80, 1, 0, 0, 0, 0, 0, 0, 77});
  Bytes out(in.size());
  shuffle_bits(in, 1, out);
  EXPECT_EQ(out, of({2, 0, 0, 0, 0, 0, 0, 1, 77}));
}

TEST(Shuffle, Inverts) {
  RandomValues random(41);
  for (const size_t record : {1, 2, 3, 4, 8, 12})
    for (const size_t size : {0, 1, 7, 8, 64, 95, 96, 1000}) {
      Bytes in(size), out(size), back(size);
      for (std::byte& byte : in) byte = static_cast<std::byte>(random.bits());
      shuffle_bytes(in, record, out);
      unshuffle_bytes(out, record, back);
      EXPECT_EQ(back, in);
      shuffle_bits(in, record, out);
      unshuffle_bits(out, record, back);
      EXPECT_EQ(back, in);
    }
}

}  // namespace
}  // namespace engram::ltm
