// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/status.h"

#include <memory>

#include "tests/ltm/expect_status.h"

namespace engram {
namespace {

TEST(Status, IsOkByDefault) {
  EXPECT_TRUE(Status().ok());
  EXPECT_EQ(Status().to_string(), "ok");
}

TEST(Status, SaysWhatFailed) {
  const Status status = data_loss("journal '{}': {} bytes", "j", 3);
  EXPECT_FALSE(status.ok());
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_EQ(status.to_string(), "data loss: journal 'j': 3 bytes");
}

TEST(Status, TellsItsContext) {
  const Status status = not_found("file").with_context("store");
  EXPECT_EQ(status.message(), "store: file");
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_TRUE(Status().with_context("store").ok());
}

TEST(Status, HasOneMakerPerCode) {
  EXPECT_EQ(invalid_argument("x").code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(already_exists("x").code(), StatusCode::kAlreadyExists);
  EXPECT_EQ(failed_precondition("x").code(), StatusCode::kFailedPrecondition);
  EXPECT_EQ(resource_exhausted("x").code(), StatusCode::kResourceExhausted);
  EXPECT_EQ(unavailable("x").code(), StatusCode::kUnavailable);
  EXPECT_EQ(cancelled("x").code(), StatusCode::kCancelled);
}

Result<int> half(int value) {
  if (value % 2 != 0) return invalid_argument("{} is odd", value);
  return value / 2;
}

Result<int> quarter(int value) {
  ENGRAM_ASSIGN_OR_RETURN(const int once, half(value));
  ENGRAM_ASSIGN_OR_RETURN(const int twice, half(once));
  return twice;
}

Status check_quarter(int value) {
  ENGRAM_RETURN_IF_ERROR(quarter(value).status());
  if (value > 100) ENGRAM_RETURN_IF_ERROR(cancelled("large"));
  return {};
}

TEST(Result, PassesValuesAndErrorsOn) {
  EXPECT_EQ(*quarter(8), 2);
  EXPECT_FAILS(quarter(6), StatusCode::kInvalidArgument, "3 is odd");
  EXPECT_OK(check_quarter(8));
  EXPECT_FAILS(check_quarter(7), StatusCode::kInvalidArgument, "7 is odd");
  EXPECT_FAILS(check_quarter(200), StatusCode::kCancelled, "large");
  EXPECT_EQ(half(3).value_or(5), 5);
  EXPECT_EQ(half(4).value_or(5), 2);
}

TEST(Result, HoldsWhatCanOnlyMove) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(4);
  EXPECT_EQ(**result, 4);
  const std::unique_ptr<int> taken = *std::move(result);
  EXPECT_EQ(*taken, 4);
}

TEST(ResultDeathTest, AbortsWhereThereIsNoValue) {
  EXPECT_DEATH((void)*half(3), "invalid argument: 3 is odd");
  EXPECT_DEATH(Result<int>(Status{}), "needs an error");
  EXPECT_DEATH(Status(StatusCode::kOk, "fine"), "needs an error code");
}

TEST(CheckDeathTest, NamesTheValues) {
  const int three = 3;
  EXPECT_DEATH(ENGRAM_CHECK(three == 4, "three is {}", three), "three == 4 .*three is 3");
  ENGRAM_CHECK(three == 3, "never");
}

}  // namespace
}  // namespace engram
