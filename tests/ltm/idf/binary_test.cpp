// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/binary.h"

#include "ltm/idf/encode_past_caches.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::idf {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes{std::byte{'I'}, std::byte{'D'}, std::byte{'F'}, std::byte{1}};
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST(Binary, GivesBackRandomValues) {
  RandomValues random(3);
  for (int i = 0; i < 3000; ++i) {
    const Data value = random.value(5);
    const auto bytes = encode(value);
    ASSERT_OK(bytes);
    EXPECT_EQ(bytes->size(), encoded_size(value));
    const auto decoded = decode(Buffer::copy(*bytes));
    ASSERT_OK(decoded);
    EXPECT_EQ(*decoded, value);
    EXPECT_EQ(*encode(*decoded), *bytes);
  }
}

TEST(Binary, WritesTheBytesOfTheFormat) {
  // Part of the format: these bytes never change.
  EXPECT_EQ(*encode(Data()), bytes_of({0}));
  EXPECT_EQ(*encode(Data(false)), bytes_of({1}));
  EXPECT_EQ(*encode(Data(true)), bytes_of({2}));
  EXPECT_EQ(*encode(Data(-2)), bytes_of({3, 0xfe, 0xff, 0xff, 0xff}));
  EXPECT_EQ(*encode(Data(int64_t{258})), bytes_of({4, 2, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(*encode(Data(1.0f)), bytes_of({5, 0, 0, 0x80, 0x3f}));
  EXPECT_EQ(*encode(Data(1.0)), bytes_of({6, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f}));
  EXPECT_EQ(*encode(Data("hi")), bytes_of({7, 2, 'h', 'i'}));
  EXPECT_EQ(*encode(Data(List{true, Data()})), bytes_of({9, 2, 2, 0}));
  EXPECT_EQ(*encode(Data(Dict{{"k", false}})), bytes_of({10, 1, 1, 'k', 1}));
  EXPECT_EQ(*encode(Data(NdArray::take<uint16_t>({1, 2}, {7, 8}))),
            bytes_of({8, 6, 2, 1, 2, 0, 0, 0, 0, 0, 0, 0, 7, 0, 8, 0}));
}

TEST(Binary, WritesTheSameBytesPastTheCaches) {
  std::vector<uint8_t> pixels(100'001);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(i * i >> 3);
  const Data value = Dict{{"image", NdArray::take({100'001}, pixels)}, {"name", "a"}};
  const auto bytes = encode(value);
  ASSERT_TRUE(bytes.ok());
  std::vector<uint64_t> words(encoded_size(value) / 8 + 1);
  const auto out = std::as_writable_bytes(std::span(words)).first(encoded_size(value));
  ASSERT_TRUE(encode_past_caches(value, out).ok());
  EXPECT_TRUE(std::ranges::equal(out, *bytes));
}

TEST(Binary, NestsSixtyFourLevelsDeep) {
  for (const Data& value : {nested_lists(64), nested_dicts(64)}) {
    const auto bytes = encode(value);
    ASSERT_OK(bytes);
    EXPECT_EQ(*decode(Buffer::copy(*bytes)), value);
  }
  EXPECT_FAILS(encode(nested_lists(65)), StatusCode::kInvalidArgument, "64 levels");
  EXPECT_FAILS(encode(nested_dicts(65)), StatusCode::kInvalidArgument, "64 levels");
  Bytes deep = bytes_of({});
  for (int i = 0; i < 65; ++i) deep.insert(deep.end(), {std::byte{9}, std::byte{1}});
  deep.push_back(std::byte{0});
  EXPECT_FAILS(decode(Buffer::copy(deep)), StatusCode::kDataLoss, "64 levels");
}

TEST(Binary, ViewsTheBytesOfArrays) {
  const Data value = Dict{{"x", true}, {"a", NdArray::take<double>({2}, {1.5, 2.5})}};
  const Buffer buffer = Buffer::take(*encode(value));
  const auto decoded = decode(buffer);
  ASSERT_OK(decoded);
  const auto* data = decoded->at("a")->get<NdArray>().bytes().data();
  EXPECT_GE(data, buffer.data());
  EXPECT_LT(data, buffer.data() + buffer.size());
  EXPECT_EQ((data - buffer.data()) % 8, 0);
}

TEST(Binary, CopiesArraysOfABufferThatIsNotAligned) {
  const Data value = NdArray::take<double>({2}, {1.5, 2.5});
  Bytes shifted = *encode(value);
  shifted.insert(shifted.begin(), std::byte{0});
  const Buffer buffer = Buffer::take(std::move(shifted));
  const auto decoded = decode(buffer.slice(1, buffer.size() - 1));
  ASSERT_OK(decoded);
  EXPECT_EQ(*decoded, value);
}

TEST(Binary, RefusesEveryTruncation) {
  RandomValues random(4);
  for (int i = 0; i < 60; ++i) {
    const Bytes bytes = *encode(random.value(4));
    for (size_t size = 0; size < bytes.size(); ++size)
      EXPECT_FAILS(decode(Buffer::copy({bytes.data(), size})), StatusCode::kDataLoss, "IDF bytes");
  }
}

TEST(Binary, RefusesBytesBehindTheValue) {
  EXPECT_FAILS(decode(Buffer::copy(bytes_of({0, 0}))), StatusCode::kDataLoss, "1 bytes after");
}

TEST(Binary, SurvivesAHundredThousandRandomFlips) {
  RandomValues random(5);
  size_t readable = 0;
  for (int i = 0; i < 100; ++i) {
    const Bytes bytes = *encode(random.value(5));
    for (int k = 0; k < 1000; ++k) {
      Bytes damaged = bytes;
      for (size_t flips = 1 + random.below(4); flips > 0; --flips)
        damaged[random.below(damaged.size())] = static_cast<std::byte>(random.bits());
      const auto decoded = decode(Buffer::take(std::move(damaged)));
      if (!decoded.ok()) continue;
      ++readable;
      EXPECT_OK(encode(*decoded));
    }
  }
  EXPECT_GT(readable, 0u);
}

TEST(Binary, RefusesSizesBeyondTheBytes) {
  const int many = 0xff;
  for (const int tag : {7, 9, 10})
    EXPECT_FAILS(
        decode(Buffer::copy(bytes_of({tag, many, many, many, many, many, many, many, 0x7f, 0, 0}))),
        StatusCode::kDataLoss, "announced");
  // A length of more than 64 bits.
  EXPECT_FAILS(
      decode(Buffer::copy(bytes_of({7, many, many, many, many, many, many, many, many, many, 2}))),
      StatusCode::kDataLoss, "exceeds 64 bits");
  // An array of 2^40 elements; one whose size in bytes overflows; rank 17; an unknown type.
  EXPECT_FAILS(decode(Buffer::copy(bytes_of({8, 5, 1, 0x80, 0x80, 0x80, 0x80, 0x80, 0x20, 0, 0}))),
               StatusCode::kDataLoss, "exceeds the");
  EXPECT_FAILS(decode(Buffer::copy(bytes_of(
                   {8, 10, 2, many, many, many, many, many, many, many, many, 0x7f, 8, 0, 0}))),
               StatusCode::kDataLoss, "exceeds the");
  EXPECT_FAILS(decode(Buffer::copy(bytes_of({8, 5, 17, 0}))), StatusCode::kDataLoss, "rank above");
  EXPECT_FAILS(decode(Buffer::copy(bytes_of({8, 11, 0, 0}))), StatusCode::kDataLoss,
               "unknown type");
  EXPECT_FAILS(decode(Buffer::copy(bytes_of({11}))), StatusCode::kDataLoss, "unknown tag 11");
}

TEST(Binary, RefusesAKeyThatComesTwice) {
  EXPECT_FAILS(decode(Buffer::copy(bytes_of({10, 2, 1, 'k', 0, 1, 'k', 0}))), StatusCode::kDataLoss,
               "'k' twice");
  Bytes large = bytes_of({10, 20});
  for (int i = 0; i < 20; ++i)
    for (const int byte : {1, 'a' + i % 19, 0}) large.push_back(static_cast<std::byte>(byte));
  EXPECT_FAILS(decode(Buffer::copy(large)), StatusCode::kDataLoss, "'a' twice");
}

}  // namespace
}  // namespace engram::idf
