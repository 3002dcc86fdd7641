// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/name_pattern.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

using Kind = NamePattern::Kind;

TEST(NamePattern, TellsAllNamesAndExpressionsApart) {
  const std::pair<const char*, Kind> cases[] = {
      {".*", Kind::kAll},        {"cam", Kind::kName},      {"cam\\.1", Kind::kName},
      {"cam.1", Kind::kRegex},   {"a b", Kind::kName},      {"a\\/b", Kind::kName},
      {"\\d", Kind::kRegex},     {"a|b", Kind::kRegex},     {"\\.\\*", Kind::kName},
      {"(?i)cam", Kind::kRegex}, {"größe-1_x", Kind::kName}};
  for (const auto& [text, kind] : cases) {
    const auto pattern = NamePattern::parse(text);
    ASSERT_OK(pattern);
    EXPECT_EQ(pattern->kind(), kind) << text;
    EXPECT_EQ(NamePattern::parse(pattern->to_string()).value(), *pattern) << text;
  }
  EXPECT_EQ(NamePattern().kind(), Kind::kAll);
}

TEST(NamePattern, OfANameMatchesItAlone) {
  RandomValues random(61);
  for (int i = 0; i < 3000; ++i) {
    const std::string name = "." + random.text();
    const NamePattern pattern = *NamePattern::name(name);
    EXPECT_EQ(pattern.kind(), Kind::kName);
    EXPECT_TRUE(pattern.matches(name));
    EXPECT_FALSE(pattern.matches(name + "x"));
    EXPECT_FALSE(pattern.matches("x" + name.substr(1)));
    const auto read = NamePattern::parse(pattern.to_string());
    ASSERT_OK(read);
    EXPECT_EQ(*read, pattern) << pattern.to_string();
  }
}

TEST(NamePattern, MatchesWholeNames) {
  const auto matches = [](const char* pattern, const char* name) {
    return NamePattern::parse(pattern)->matches(name);
  };
  EXPECT_TRUE(matches("cam.*", "camera"));
  EXPECT_FALSE(matches("cam.", "camera"));
  EXPECT_FALSE(matches("amera|cam", "camera"));
  EXPECT_TRUE(matches("(x)", "(x)"));  // letter by letter
  EXPECT_TRUE(matches("(x)", "x"));
  EXPECT_TRUE(matches(".", "é"));
  EXPECT_TRUE(matches("a\\/.", "a/b"));
  EXPECT_TRUE(matches("a\\;b", "a;b"));
  EXPECT_FALSE(matches("cam", "Cam"));
}

TEST(NamePattern, CopiesShareWhatWasCompiled) {
  const NamePattern pattern = *NamePattern::parse("c(a|b)*d");
  NamePattern copy;
  {
    const NamePattern other = pattern;
    copy = other;
  }
  EXPECT_EQ(copy, pattern);
  EXPECT_TRUE(copy.matches("cababd"));
  EXPECT_FALSE(copy == NamePattern());
}

TEST(NamePattern, StaysLinearOnCatastrophicExpressions) {
  const NamePattern pattern = *NamePattern::parse("((a*)*)*b|(x+x+)+y");
  EXPECT_FALSE(pattern.matches(std::string(100'000, 'a')));
  EXPECT_FALSE(pattern.matches(std::string(100'000, 'x')));
}

TEST(NamePattern, RefusesWhatIsNone) {
  const std::pair<std::string, const char*> cases[] = {
      {"", "is empty"},
      {"(", "missing )"},
      {"a\\", "trailing \\"},
      {"a\xff", "no UTF-8"},
      {"\\Qa.b\\E", "quotes by '\\Q'"},
      {"a{2000}", "repetition"},
      {"(((a{100}){100}){100})", "no regular expression"},
      {"\\C{1000}(x\\pL{300}){3}", "no regular expression"}};
  for (const auto& [text, part] : cases)
    EXPECT_FAILS(NamePattern::parse(text), StatusCode::kInvalidArgument, part);
  EXPECT_FAILS(NamePattern::name(""), StatusCode::kInvalidArgument, "is empty");
  EXPECT_FAILS(NamePattern::name("\xff"), StatusCode::kInvalidArgument, "no UTF-8");
}

}  // namespace
}  // namespace engram::ltm
