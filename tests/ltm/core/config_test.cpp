// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/config.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

ConfigMap map_of(std::string_view text) {
  return *ConfigValue::parse(text, "f.yaml")->map();
}

ConfigValue value_of(const std::string& text) {
  return *map_of("key: " + text + "\n").find("key");
}

#define EXPECT_REFUSED(expression, ...)                       \
  do {                                                        \
    const Status refused_ = status_of(expression);            \
    EXPECT_EQ(refused_.code(), StatusCode::kInvalidArgument); \
    EXPECT_THAT(refused_.message(), AllOf(__VA_ARGS__));      \
  } while (false)

TEST(Config, ReadsEveryKindOfValue) {
  EXPECT_EQ(*value_of("some text").text(), "some text");
  EXPECT_EQ(*value_of("\"5\"").text(), "5");
  EXPECT_TRUE(value_of("'5'").is_quoted());
  EXPECT_FALSE(value_of("5").is_quoted());
  EXPECT_EQ(*value_of("true").boolean(), true);
  EXPECT_EQ(*value_of("-2.5e3").number(), -2500);
  EXPECT_EQ(*value_of("-7").integer(), -7);
  EXPECT_EQ(*value_of("200ms").duration(), std::chrono::milliseconds(200));
  EXPECT_EQ(*value_of("64MiB").bytes(), uint64_t{64} << 20);
  EXPECT_EQ(*value_of("1.5kB").bytes(), 1500u);
  EXPECT_EQ(*value_of("5Hz").rate_hz(), 5);
  EXPECT_EQ(*value_of("0.5kHz").rate_hz(), 500);
  const auto list = *value_of("[1, [2], {a: 3}]").list();
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(*list[0].integer(), 1);
  EXPECT_EQ(*(*list[1].list())[0].integer(), 2);
  EXPECT_EQ(*list[2].map()->find("a")->integer(), 3);
}

TEST(Config, NamesFileLineKeyAndWhatIsNeeded) {
  ConfigMap top = map_of("a:\n  list:\n    - 1\n    - five apples\n");
  const auto list = *top.find("a")->map()->find("list")->list();
  EXPECT_REFUSED(list[1].rate_hz(), HasSubstr("f.yaml:4: 'a.list[1]'"), HasSubstr("'five apples'"),
                 HasSubstr("5Hz"));
  EXPECT_REFUSED(top.find("a")->text(), HasSubstr("f.yaml:"), HasSubstr("found a map"),
                 HasSubstr("needs a text"));
  EXPECT_REFUSED(top.require("b"), HasSubstr("no key 'b'"));
}

TEST(Config, RefusesValuesOfAnotherKind) {
  for (const char* text : {"5", "5 Hz", "-5Hz", "0Hz", "Hz", "nanHz", "infHz", "[5Hz]"})
    EXPECT_REFUSED(value_of(text).rate_hz(), HasSubstr("needs a rate"));
  for (const char* text : {"5", "-1B", "1e30TB", "MiB", "5 MiB", "64Mib"})
    EXPECT_REFUSED(value_of(text).bytes(), HasSubstr("needs a size"));
  for (const char* text : {"5", "-5s", "1 s", "1e300d", "soon", "{}"})
    EXPECT_REFUSED(value_of(text).duration(), HasSubstr("needs a duration"));
  for (const char* text : {"nan", "inf", "1.5x", "true", "1e999"})
    EXPECT_REFUSED(value_of(text).number(), HasSubstr("needs a number"));
  for (const char* text : {"1.5", "99999999999999999999", "0x10", "''", "[]"})
    EXPECT_REFUSED(value_of(text).integer(), HasSubstr("whole number"));
  for (const char* text : {"yes", "1", "\"true\"", "True"})
    EXPECT_REFUSED(value_of(text).boolean(), HasSubstr("true or false"));
}

TEST(Config, SuggestsTheKnownKeyThatIsClosest) {
  ConfigMap map = map_of("thraeds: 2\n");
  map.find("threads");
  map.find("late");
  EXPECT_REFUSED(map.finish(), HasSubstr("f.yaml:1: 'thraeds'"), HasSubstr("mean 'threads'?"));
  ConfigMap far = map_of("\n\nsomething: 2\n");
  far.find("late");
  EXPECT_REFUSED(far.finish(), HasSubstr("f.yaml:3"), HasSubstr("known are late"));
  ConfigMap known = map_of("late: 2\n");
  known.find("late");
  EXPECT_OK(known.finish());
}

TEST(Config, TakesTheOldNameOfAKeyWithAWarning) {
  constexpr DeprecatedWord kKey{"most", "max", "0.3"};
  uint64_t size = 0;
  ConfigMap old = map_of("most: 2kB\n");
  ::testing::internal::CaptureStderr();
  EXPECT_OK(old.read(kKey, size, &ConfigValue::bytes));
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr("'most'"), HasSubstr("'max'"), HasSubstr("version 0.3")));
  EXPECT_EQ(size, 2000u);
  EXPECT_OK(old.finish());

  ConfigMap now = map_of("max: 3kB\n");
  ::testing::internal::CaptureStderr();
  EXPECT_OK(now.read(kKey, size, &ConfigValue::bytes));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(size, 3000u);

  ConfigMap both = map_of("max: 3kB\nmost: 3kB\n");
  EXPECT_REFUSED(both.find(kKey), HasSubstr("f.yaml:2"), HasSubstr("'most'"), HasSubstr("'max'"));
  ConfigMap wrong = map_of("mix: 3kB\n");
  EXPECT_OK(wrong.find(kKey));
  EXPECT_REFUSED(wrong.finish(), HasSubstr("mean 'max'?"));
}

TEST(Config, FindsTheClosestWord) {
  const std::vector<std::string> known{"frequency", "equality", "match", "rate"};
  EXPECT_EQ(closest_word("frequence", known), "frequency");
  EXPECT_EQ(closest_word("mach", known), "match");
  EXPECT_EQ(closest_word("rat", known), "rate");
  EXPECT_EQ(closest_word("xy", known), std::nullopt);
  EXPECT_EQ(closest_word("", known), std::nullopt);
  EXPECT_EQ(closest_word(std::string(100'000, 'a'), known), std::nullopt);
}

TEST(Config, TakesNullAndNothingForAMissingValue) {
  ConfigMap map = map_of("a: ~\nb:\nc: null\nd: \"\"\n");
  for (const char* key : {"a", "b", "c"}) EXPECT_FALSE(map.find(key).has_value()) << key;
  EXPECT_EQ(*map.find("d")->text(), "");
  EXPECT_OK(map.finish());
  EXPECT_TRUE(map_of("").keys().empty());
  EXPECT_TRUE(map_of("# a comment\n").keys().empty());
  EXPECT_TRUE(map_of("---\n").keys().empty());
}

TEST(Config, RefusesWhatIsNotPlainYaml) {
  const auto parse = [](const std::string& text) { return ConfigValue::parse(text, "f.yaml"); };
  EXPECT_REFUSED(parse("a: 1\nb: 2\na: 3\n"), HasSubstr("f.yaml:3"), HasSubstr("'a' again"),
                 HasSubstr("line 1"));
  EXPECT_REFUSED(parse("a: &x 1\n"), HasSubstr("anchor"));
  EXPECT_REFUSED(parse("a: &x {b: 1}\n"), HasSubstr("anchor"));
  EXPECT_REFUSED(parse("a: 1\nb: *a\n"), HasSubstr("f.yaml:2"));
  EXPECT_REFUSED(parse("a: !!int 1\n"), HasSubstr("tag"));
  EXPECT_REFUSED(parse("a: 1\n---\nb: 2\n"), HasSubstr("second document"));
  EXPECT_REFUSED(parse("? {a: 1}\n: 2\n"), HasSubstr("key that is no text"));
  EXPECT_REFUSED(parse("a: [1, 2\n"), HasSubstr("is no YAML"));
  EXPECT_REFUSED(parse("a: b: c\n"), HasSubstr("f.yaml:1"), HasSubstr("is no YAML"));
  EXPECT_REFUSED(parse("- 1\n")->map(), HasSubstr("found a list"));
}

TEST(Config, BoundsWhatItReads) {
  const auto parse = [](const std::string& text) { return ConfigValue::parse(text, "f.yaml"); };
  EXPECT_OK(parse(std::string(64, '[') + std::string(64, ']')));
  EXPECT_REFUSED(parse(std::string(65, '[') + std::string(65, ']')), HasSubstr("64 levels"));
  EXPECT_REFUSED(parse(std::string(100'000, '[')), HasSubstr("f.yaml:1"));
  EXPECT_REFUSED(parse(std::string(ConfigValue::kMaxBytes + 1, '#')), HasSubstr("at most"));
  std::string many;
  for (int i = 0; i < 30'000; ++i) many += fmt::format("k{}: 1\n", i);
  EXPECT_REFUSED(parse(many), HasSubstr("more than 20000 values"));
}

TEST(Config, NeverCrashesOnDamagedText) {
  const std::string whole =
      "preset: balanced\nentities:\n  - match: .*\n    filters: [{frequency: {rate: 5Hz}}]\n";
  for (size_t i = 0; i < whole.size(); ++i) {
    EXPECT_TRUE(ConfigValue::parse(whole.substr(0, i), "f").ok() || i > 0);
    for (const char byte : {'\0', '\xff', '{', '*', '\t', '"', '%', '|'}) {
      std::string damaged = whole;
      damaged[i] = byte;
      const auto parsed = ConfigValue::parse(damaged, "f");
      EXPECT_TRUE(parsed.ok() || parsed.status().code() == StatusCode::kInvalidArgument);
    }
  }
}

TEST(Config, ReadsFiles) {
  const ScratchDirectory directory;
  overwrite_file(directory / "c.yaml", std::as_bytes(std::span(std::string_view("a: 1\n"))));
  EXPECT_EQ(*ConfigValue::read_file(directory / "c.yaml")->map()->find("a")->integer(), 1);
  EXPECT_FAILS(ConfigValue::read_file(directory / "none.yaml"), StatusCode::kNotFound, "none.yaml");
  EXPECT_FALSE(ConfigValue::read_file(directory.path()).ok());
}

}  // namespace
}  // namespace engram
