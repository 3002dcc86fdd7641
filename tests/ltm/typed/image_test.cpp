// SPDX-License-Identifier: Apache-2.0
#include "ltm/typed/image.h"

#include <gtest/gtest.h>

#include <memory>
#include <opencv2/imgproc.hpp>

namespace engram::typed {
namespace {

using idf::PixelType;

cv::Mat picture() {
  cv::Mat mat(4, 6, CV_8UC3);
  for (int i = 0; i < 72; ++i) mat.data[i] = static_cast<uint8_t>(i);
  return mat;
}

/// An array whose buffer tells when it is gone.
struct Watched {
  idf::NdArray array;
  std::weak_ptr<const void> owner;
};

Watched watched() {
  auto values = std::make_shared<std::vector<uint8_t>>(72, uint8_t{9});
  const Buffer buffer(values, std::as_bytes(std::span(*values)));
  return {idf::NdArray::create(idf::ElementType::kUInt8, {4, 6, 3}, buffer).value(), values};
}

TEST(Image, IsNotCopiedIntoAValue) {
  const cv::Mat mat = picture();
  const auto array = array_of(mat, PixelType::kRgb24);
  ASSERT_TRUE(array.has_value());
  EXPECT_EQ(static_cast<const void*>(array->bytes().data()), mat.data);
  EXPECT_EQ(array->shape(), (idf::Shape{4, 6, 3}));
  EXPECT_EQ(mat.u->refcount, 2);
}

TEST(Image, IsNotCopiedFromAValue) {
  const Watched source = watched();
  const auto mat = mat_of(source.array);
  ASSERT_TRUE(mat.has_value());
  EXPECT_EQ(static_cast<const void*>(mat->data), source.array.bytes().data());
  EXPECT_EQ(mat->type(), CV_8UC3);
  EXPECT_EQ(mat->size(), cv::Size(6, 4));
}

TEST(Image, ValueOutlivesTheMat) {
  cv::Mat mat = picture();
  const auto array = array_of(mat, PixelType::kRgb24);
  mat.release();
  ASSERT_TRUE(array.has_value());
  EXPECT_EQ(array->values<uint8_t>()[71], 71);
}

TEST(Image, MatOutlivesTheValueAndLetsItGo) {
  Watched source = watched();
  cv::Mat mat = *mat_of(source.array);
  source.array = idf::NdArray();
  EXPECT_FALSE(source.owner.expired());
  cv::Mat second = mat;
  cv::Mat part = mat(cv::Rect(1, 1, 2, 2));
  mat.release();
  second = cv::Mat();
  EXPECT_FALSE(source.owner.expired());
  EXPECT_EQ(part.at<cv::Vec3b>(1, 1)[2], 9);
  part = cv::Mat(2, 2, CV_8UC3);
  EXPECT_TRUE(source.owner.expired());
}

TEST(Image, WorksWithOpenCv) {
  const Watched source = watched();
  cv::Mat mat = *mat_of(source.array);
  cv::Mat clone = mat.clone();
  EXPECT_NE(clone.data, mat.data);
  clone.setTo(cv::Scalar(1, 2, 3));
  EXPECT_EQ(source.array.values<uint8_t>()[0], 9);
  cv::Mat larger;
  cv::resize(mat, larger, {12, 8});
  EXPECT_EQ(larger.at<cv::Vec3b>(7, 11)[0], 9);
  cv::Mat copy;
  mat.copyTo(copy);
  EXPECT_NE(copy.data, mat.data);
  mat.create(5, 5, CV_32FC1);
  EXPECT_NE(static_cast<const void*>(mat.data), source.array.bytes().data());
  mat.setTo(1.0f);
  EXPECT_EQ(source.array.values<uint8_t>()[0], 9);
}

TEST(Image, RoundTripsDoNotWrapEachOther) {
  const Watched source = watched();
  idf::NdArray array = source.array;
  for (int i = 0; i < 3; ++i) array = *array_of(*mat_of(array), PixelType::kRgb24);
  EXPECT_EQ(array.buffer().owner(), source.array.buffer().owner());
}

TEST(Image, PartOfAWiderOneIsCopied) {
  const cv::Mat mat = picture();
  const auto array = array_of(mat(cv::Rect(1, 1, 2, 3)), PixelType::kRgb24);
  ASSERT_TRUE(array.has_value());
  EXPECT_EQ(array->shape(), (idf::Shape{3, 2, 3}));
  EXPECT_EQ(array->values<uint8_t>()[0], mat.at<cv::Vec3b>(1, 1)[0]);
  EXPECT_EQ(array->values<uint8_t>()[6], mat.at<cv::Vec3b>(2, 1)[0]);
}

TEST(Image, MemoryOfOthersIsCopied) {
  std::vector<uint8_t> pixels(6, 5);
  const auto array = array_of(cv::Mat(2, 3, CV_8UC1, pixels.data()), PixelType::kMono8);
  ASSERT_TRUE(array.has_value());
  EXPECT_NE(static_cast<const void*>(array->bytes().data()), pixels.data());
  pixels.assign(6, 0);
  EXPECT_EQ(array->values<uint8_t>()[5], 5);
}

TEST(Image, EmptyMatHasTheChannelsOfItsPixels) {
  const auto array = array_of(cv::Mat(), PixelType::kDepth16);
  ASSERT_TRUE(array.has_value());
  EXPECT_EQ(array->type(), idf::ElementType::kUInt16);
  EXPECT_EQ(array->shape(), (idf::Shape{0, 0, 1}));
}

TEST(Image, WhatIsNoImageIsRefused) {
  const int sizes[] = {2, 2, 2};
  EXPECT_FALSE(array_of(cv::Mat(3, sizes, CV_8UC1), PixelType::kMono8).has_value());
  EXPECT_FALSE(array_of(cv::Mat(2, 2, CV_16FC1), PixelType::kMono8).has_value());
  using idf::NdArray;
  EXPECT_FALSE(mat_of(NdArray::take<uint8_t>({2, 2}, std::vector<uint8_t>(4))).has_value());
  EXPECT_FALSE(mat_of(NdArray::take<uint64_t>({1, 1, 1}, {1})).has_value());
  EXPECT_FALSE(mat_of(NdArray::take<uint8_t>({0, 1, 513}, {})).has_value());
  EXPECT_FALSE(mat_of(NdArray::take<uint8_t>({int64_t{1} << 31, 0, 1}, {})).has_value());
}

}  // namespace
}  // namespace engram::typed
