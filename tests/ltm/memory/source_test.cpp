// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/source.h"

#include <gtest/gtest.h>

namespace engram::ltm {
namespace {

TEST(Source, HasNames) {
  EXPECT_EQ(to_string(Source::kRecorded), "recorded");
  EXPECT_EQ(to_string(Source::kReconstructed), "reconstructed");
  EXPECT_EQ(to_string(Source::kAugmented), "augmented");
  EXPECT_EQ(to_string(Source::kPredicted), "predicted");
  for (const auto source :
       {Source::kRecorded, Source::kReconstructed, Source::kAugmented, Source::kPredicted})
    EXPECT_EQ(source_from_name(to_string(source)), source);
  EXPECT_FALSE(source_from_name("Recorded").has_value());
}

TEST(MeasuredError, OfNothingMeasuredIsEqual) {
  EXPECT_EQ(MeasuredError{}, MeasuredError{});
  EXPECT_EQ(MeasuredError{.image_mse = 2}, MeasuredError{.image_mse = 2});
  EXPECT_FALSE(MeasuredError{.image_mse = 2} == MeasuredError{});
}

}  // namespace
}  // namespace engram::ltm
