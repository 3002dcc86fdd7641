// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/ndarray.h"

#include <cmath>
#include <limits>

#include "tests/ltm/expect_status.h"

namespace engram::idf {
namespace {

TEST(NdArray, NamesItsElementTypesAsNumPyDoes) {
  for (int code = 1; code <= 10; ++code) {
    const auto type = element_type_from_code(static_cast<uint8_t>(code));
    ASSERT_TRUE(type);
    EXPECT_EQ(element_type_from_name(to_string(*type)), type);
  }
  EXPECT_EQ(to_string(ElementType::kUInt8), "uint8");
  EXPECT_EQ(size_bytes(ElementType::kInt16), 2u);
  EXPECT_EQ(size_bytes(ElementType::kFloat64), 8u);
  EXPECT_EQ(element_type_from_code(0), std::nullopt);
  EXPECT_EQ(element_type_from_code(11), std::nullopt);
  EXPECT_EQ(element_type_from_name("float"), std::nullopt);
}

TEST(NdArray, CountsBytesWithoutOverflow) {
  EXPECT_EQ(size_bytes(ElementType::kFloat64, {}), 8u);
  EXPECT_EQ(size_bytes(ElementType::kFloat32, {2, 3}), 24u);
  EXPECT_EQ(size_bytes(ElementType::kUInt8, {5, 0}), 0u);
  EXPECT_EQ(size_bytes(ElementType::kUInt8, {-1}), std::nullopt);
  EXPECT_EQ(size_bytes(ElementType::kUInt16, {INT64_MAX, 2}), std::nullopt);
}

TEST(NdArray, RefusesBytesThatDoNotFit) {
  const Buffer eight = Buffer::take(std::vector<double>{1.0});
  EXPECT_OK(NdArray::create(ElementType::kFloat32, {2}, eight));
  EXPECT_FAILS(NdArray::create(ElementType::kFloat32, {3}, eight), StatusCode::kInvalidArgument,
               "found 8 bytes, needs 12");
  EXPECT_FAILS(NdArray::create(ElementType::kUInt8, {-8}, eight), StatusCode::kInvalidArgument,
               "[-8]");
  EXPECT_FAILS(NdArray::create(ElementType::kUInt16, {2}, eight.slice(1, 4)),
               StatusCode::kInvalidArgument, "not aligned");
}

TEST(NdArray, SharesItsBuffer) {
  const NdArray array = NdArray::take<int32_t>({2, 2}, {1, 2, 3, 4});
  const NdArray copy = array;
  EXPECT_EQ(copy.bytes().data(), array.bytes().data());
  EXPECT_EQ(copy.values<int32_t>()[3], 4);
  EXPECT_EQ(copy.count(), 4);
  EXPECT_EQ(copy.rank(), 2u);
  EXPECT_EQ(to_string(copy.shape()), "[2, 2]");
}

TEST(NdArray, ComparesBitByBit) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(NdArray::take<float>({1}, {nan}), NdArray::take<float>({1}, {nan}));
  EXPECT_NE(NdArray::take<float>({1}, {0.0f}), NdArray::take<float>({1}, {-0.0f}));
  EXPECT_NE(NdArray::take<float>({1}, {1}), NdArray::take<float>({}, {1}));
  EXPECT_NE(NdArray::take<float>({1}, {0}), NdArray::take<int32_t>({1}, {0}));
  EXPECT_EQ(NdArray(), NdArray::take<uint8_t>({0}, {}));
}

TEST(NdArrayDeathTest, ChecksTheElementType) {
  const NdArray array = NdArray::take<int32_t>({1}, {1});
  EXPECT_DEATH((void)array.values<float>(), "array has int32");
}

TEST(SizeBytes, IsZeroWhereAnyAxisIsWhateverTheOthers) {
  constexpr int64_t kHuge = int64_t{1} << 40;
  EXPECT_EQ(size_bytes(ElementType::kFloat32, {kHuge, kHuge, 0}), 0u);
  EXPECT_EQ(size_bytes(ElementType::kFloat32, {0, kHuge, kHuge}), 0u);
  EXPECT_EQ(size_bytes(ElementType::kFloat32, {kHuge, kHuge}), std::nullopt);
  EXPECT_EQ(size_bytes(ElementType::kFloat32, {0, -1}), std::nullopt);
}

}  // namespace
}  // namespace engram::idf
