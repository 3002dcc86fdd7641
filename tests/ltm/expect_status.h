// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

#include "ltm/core/status.h"

namespace engram {

inline void PrintTo(StatusCode code, std::ostream* out) {
  *out << to_string(code);
}
inline void PrintTo(const Status& status, std::ostream* out) {
  *out << status.to_string();
}

inline Status status_of(const Status& status) {
  return status;
}
template <typename T>
Status status_of(const Result<T>& result) {
  return result.status();
}

}  // namespace engram

/// Expects ok of a Status or a Result.
#define EXPECT_OK(expression)                                              \
  do {                                                                     \
    const ::engram::Status found_ = ::engram::status_of(expression);       \
    EXPECT_TRUE(found_.ok()) << #expression << ": " << found_.to_string(); \
  } while (false)
#define ASSERT_OK(expression)                                              \
  do {                                                                     \
    const ::engram::Status found_ = ::engram::status_of(expression);       \
    ASSERT_TRUE(found_.ok()) << #expression << ": " << found_.to_string(); \
  } while (false)

/// Expects an error of this code whose message has `part`.
#define EXPECT_FAILS(expression, expected_code, part)                                     \
  do {                                                                                    \
    const ::engram::Status found_ = ::engram::status_of(expression);                      \
    EXPECT_EQ(found_.code(), expected_code) << #expression << ": " << found_.to_string(); \
    EXPECT_THAT(found_.message(), ::testing::HasSubstr(part));                            \
  } while (false)
