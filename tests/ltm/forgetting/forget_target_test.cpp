// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_target.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

/// Whether any meaning of a text may name an entity.
bool may_name(const std::string& text, const std::string& entity) {
  const auto target = ForgetTarget::parse(text);
  EXPECT_OK(target);
  return target.ok() && std::ranges::any_of(target->meanings, [&](const Query& meaning) {
           return meaning.matches(*MemoryId::parse(entity));
         });
}

TEST(ForgetTarget, ReadsIdsOfAnyLevelAsAllThatLiesBelow) {
  const auto segment = ForgetTarget::parse("Vision/RGB");
  ASSERT_OK(segment);
  ASSERT_EQ(segment->meanings.size(), 1u);
  EXPECT_EQ(segment->meanings[0].to_string(), "?ids Vision/RGB/.*/.* @ all");
  const auto instance = ForgetTarget::parse("A/b/c/d/1970-01-01 00:00:00.000000005/0");
  ASSERT_OK(instance);
  EXPECT_EQ(instance->meanings[0], *Query::parse("?ids A/b/c/d @ 5"));
}

TEST(ForgetTarget, TakesNamesLetterByLetter) {
  const auto target = ForgetTarget::parse("A/b/c/cam.*");
  ASSERT_OK(target);
  EXPECT_TRUE(may_name("A/b/c/cam.*", "A/b/c/cam.*"));
  EXPECT_FALSE(may_name("A/b/c/cam.*", "A/b/c/cam1"));
  EXPECT_FALSE(target->meanings[0].matches(*MemoryId::parse("A/b/c/cam1")));
}

TEST(ForgetTarget, ReadsQueriesWithoutTheirData) {
  const auto target = ForgetTarget::parse("A/.*/c/d @ last:10s");
  ASSERT_OK(target);
  ASSERT_TRUE(target->query.has_value());
  EXPECT_TRUE(target->query->is_ids_only());
  EXPECT_TRUE(may_name("A/.*/c/d @ last:10s", "A/x/c/d"));
  EXPECT_FALSE(may_name("A/.*/c/d @ last:10s", "A/x/c/e"));
}

TEST(ForgetTarget, MayBeBoth) {
  const auto target = ForgetTarget::parse("A/b/c/d @ all");
  ASSERT_OK(target);
  EXPECT_EQ(target->meanings.size(), 2u);
  EXPECT_TRUE(may_name("A/b/c/d @ all", "A/b/c/d @ all"));
  EXPECT_TRUE(may_name("A/b/c/d @ all", "A/b/c/d"));
}

TEST(ForgetTarget, RefusesWhatNamesNothing) {
  EXPECT_FAILS(ForgetTarget::parse(""), StatusCode::kInvalidArgument, "found ''");
  EXPECT_FAILS(ForgetTarget::parse("A/b/c/d/e/f/g"), StatusCode::kInvalidArgument, "A/b/c/d/e/f/g");
  EXPECT_FAILS(check_forget_targets({}), StatusCode::kInvalidArgument, "nothing to forget");
  EXPECT_FAILS(check_forget_targets(std::vector<std::string>(kMaxForgetTargets + 1, "A")),
               StatusCode::kInvalidArgument, "at most 1024");
}

}  // namespace
}  // namespace engram::ltm
