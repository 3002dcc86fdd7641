// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/deprecated.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::internal::CaptureStderr;
using ::testing::internal::GetCapturedStderr;

TEST(Deprecated, NamesBothWordsAndTheVersionOncePerPlace) {
  constexpr DeprecatedWord kWord{"old_one", "new_one", "0.3"};
  CaptureStderr();
  warn_deprecated(kWord, "a.old_one");
  EXPECT_THAT(GetCapturedStderr(), AllOf(HasSubstr("warning"), HasSubstr("'a.old_one'"),
                                         HasSubstr("'new_one'"), HasSubstr("version 0.3")));
  CaptureStderr();
  warn_deprecated(kWord, "a.old_one");
  EXPECT_EQ(GetCapturedStderr(), "");
  CaptureStderr();
  warn_deprecated(kWord, "b.old_one");
  EXPECT_THAT(GetCapturedStderr(), HasSubstr("'b.old_one'"));
}

}  // namespace
}  // namespace engram
