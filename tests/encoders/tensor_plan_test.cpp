// SPDX-License-Identifier: Apache-2.0
#include "encoders/tensor_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ltm/idf/cast.h"

namespace engram::encoders {
namespace {

idf::Data mixed_value() {
  idf::Dict dict;
  dict.set("image", idf::NdArray::take<uint8_t>({8, 16, 3}, std::vector<uint8_t>(8 * 16 * 3, 7)));
  dict.set("joints", idf::NdArray::take<float>({3}, {1.0f, 2.0f, 3.0f}));
  dict.set("count", int32_t{-4});
  dict.set("is_open", true);
  dict.set("name", "cup");
  return dict;
}

TEST(TensorPlan, FindsImagesAndNumbers) {
  const auto plan = TensorPlan::create(idf::Layout::of(mixed_value()));
  ASSERT_TRUE(plan.ok()) << plan.status().to_string();
  ASSERT_EQ(plan->images().size(), 1u);
  EXPECT_EQ(plan->images()[0].width, 16);
  EXPECT_EQ(plan->number_count(), 5u);
}

TEST(TensorPlan, GivesBackTheNumbers) {
  const auto plan = TensorPlan::create(idf::Layout::of(mixed_value()));
  auto split = plan->layout().split(mixed_value());
  const auto numbers = plan->read_numbers(*split);
  EXPECT_EQ(numbers, (std::vector<double>{1, 2, 3, -4, 1}));
  plan->write_numbers(numbers, split->tensors);
  EXPECT_EQ(*plan->layout().join(*split), mixed_value());
}

TEST(TensorPlan, RoundsAndClampsToTheTypesOfTheMembers) {
  const auto plan = TensorPlan::create(idf::Layout::of(mixed_value()));
  auto split = plan->layout().split(mixed_value());
  plan->write_numbers(std::vector<double>{1, 2, 3, 1e12, 0.4}, split->tensors);
  const auto value = plan->layout().join(*split);
  EXPECT_EQ(value->at("count")->get<int32_t>(), std::numeric_limits<int32_t>::max());
  EXPECT_FALSE(value->at("is_open")->get<bool>());
  plan->write_numbers(std::vector<double>{1, 2, 3, std::nan(""), 0.6}, split->tensors);
  EXPECT_EQ(plan->layout().join(*split)->at("count")->get<int32_t>(), 0);
}

TEST(TensorPlan, KnowsWhichNumbersADoubleDoesNotHold) {
  const int64_t held = int64_t{1} << 53;
  const auto inexact = [](const idf::Data& value) {
    const idf::Layout layout = idf::Layout::of(value);
    return inexact_members(layout, *layout.split(value));
  };
  for (const int64_t value : {int64_t{0}, held, -held})
    EXPECT_TRUE(inexact(value).empty()) << value;
  for (const int64_t value : {held + 1, -held - 1, INT64_MAX, INT64_MIN})
    EXPECT_EQ(inexact(value), std::vector<std::string>{""}) << value;
  idf::Dict dict;
  dict.set("small", idf::NdArray::take<int64_t>({2}, {1, -held}));
  dict.set("stamps", idf::NdArray::take<uint64_t>({2}, {1, UINT64_MAX}));
  dict.set("large", 1e300);
  EXPECT_EQ(inexact(dict), std::vector<std::string>{"stamps"});
}

TEST(TensorPlan, GivesOrientationsLengthOne) {
  const idf::Type type =
      idf::Type::object("Seen", {{"pose", idf::Type::pose()}, {"gain", idf::Type::float64()}});
  const idf::Data value = idf::default_value(type);
  const auto plan = TensorPlan::create(idf::Layout::of(value, type));
  ASSERT_TRUE(plan.ok()) << plan.status().to_string();
  const size_t turn = plan->layout().members()[0].kind == idf::MemberKind::kOrientation ? 0 : 3;
  std::vector<double> numbers(plan->number_count(), 3.0);
  for (size_t i = 0; i < 4; ++i) numbers[turn + i] = i == 1 ? -2 : 0;
  auto expected = numbers;
  expected[turn + 1] = -1;
  plan->make_orientations_unit(numbers);
  EXPECT_EQ(numbers, expected);
  expected[turn + 1] = numbers[turn + 1] = 0;
  plan->make_orientations_unit(numbers);
  EXPECT_EQ(numbers, expected) << "without a length";
}

TEST(TensorPlan, RejectsALargeArrayByName) {
  idf::Dict dict;
  dict.set("cloud", idf::NdArray::take<float>({2000, 3}, std::vector<float>(6000)));
  const auto plan = TensorPlan::create(idf::Layout::of(dict));
  ASSERT_EQ(plan.status().code(), StatusCode::kInvalidArgument);
  EXPECT_NE(plan.status().message().find("'cloud'"), std::string::npos);
}

TEST(TensorPlan, RejectsAValueWithoutTensors) {
  EXPECT_FALSE(TensorPlan::create(idf::Layout::of("text")).ok());
}

}  // namespace
}  // namespace engram::encoders
