// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_config.h"

#include <fstream>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

Result<ForgetOptions> parse(const std::string& text) {
  return parse_forget_config(text, "f.yaml");
}

TEST(ForgetConfig, ReadsEveryKey) {
  const auto options = parse(R"(
preset: balanced
entities: [{match: Vision}]
forget:
  rules:
    - {match: Vision/RGB, older_than: 30d}
    - {unread_for: 90d, read_less_than: 3}
    - {importance: {path: score, below: 0.25}}
    - {match: Objects, saliency: {keep: 0.1}}
    - {older_than: 1d, redundant: {numbers: {measure: rms, bound: 0.1}, max_gap: 1min}}
  quota:
    max_bytes: 200GiB
    min_free_disk: 10GiB
    first: [{redundant: {}}, {importance: {}}, {saliency: {below: 0.5}}]
  protect: {entities: [Grasp, .*/Pose], newest: 5, younger_than: 7d, linked: true}
)");
  ASSERT_OK(options);
  ASSERT_THAT(options->rules, SizeIs(5));
  EXPECT_EQ(options->rules[0].match.to_string(), "Vision/RGB");
  EXPECT_EQ(options->rules[0].age->older_than, std::chrono::hours(720));
  EXPECT_EQ(options->rules[1].access->unread_for, std::chrono::hours(24 * 90));
  EXPECT_EQ(options->rules[1].access->read_less_than, 3u);
  EXPECT_EQ(options->rules[2].importance->path, "score");
  EXPECT_EQ(options->rules[2].importance->below, 0.25);
  EXPECT_EQ(options->rules[3].saliency->keep, 0.1);
  EXPECT_FALSE(options->rules[3].saliency->below);
  EXPECT_TRUE(options->rules[4].age && options->rules[4].redundancy);
  EXPECT_EQ(options->rules[4].redundancy->numbers.measure, Measure::kRms);
  EXPECT_EQ(options->rules[4].redundancy->max_gap, std::chrono::minutes(1));
  EXPECT_EQ(options->max_bytes, uint64_t{200} << 30);
  EXPECT_EQ(options->min_free_disk_bytes, uint64_t{10} << 30);
  EXPECT_THAT(options->first, SizeIs(3));
  EXPECT_EQ(options->first[2].saliency->below, 0.5);
  EXPECT_THAT(options->protection.entities, SizeIs(2));
  EXPECT_EQ(options->protection.newest, 5u);
  EXPECT_EQ(options->protection.younger_than, std::chrono::hours(168));
  EXPECT_TRUE(options->protection.linked);
}

TEST(ForgetConfig, ProtectsTheNewestByDefault) {
  const auto options = parse("forget: {}");
  ASSERT_OK(options);
  EXPECT_EQ(options->protection.newest, 1u);
  EXPECT_FALSE(options->protection.linked);
  EXPECT_FALSE(options->max_bytes.has_value());
}

TEST(ForgetConfig, TakesTheOldNamesOfQuotasWithAWarning) {
  ::testing::internal::CaptureStderr();
  const auto options = parse("forget: {quota: {most_bytes: 2GiB, least_free_disk: 1GiB}}");
  const std::string told = ::testing::internal::GetCapturedStderr();
  ASSERT_OK(options);
  EXPECT_EQ(options->max_bytes, uint64_t{2} << 30);
  EXPECT_EQ(options->min_free_disk_bytes, uint64_t{1} << 30);
  for (const char* word : {"forget.quota.most_bytes", "'max_bytes'", "forget.quota.least_free_disk",
                           "'min_free_disk'", "version 0.3"})
    EXPECT_THAT(told, HasSubstr(word));
}

TEST(ForgetConfig, IsStrict) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"entities: []", "forget"},
      {"forget: {}\nfoget: {}", "foget"},
      {"forget: {rule: []}", "rules"},
      {"forget: {rules: [{}]}", "has no policy"},
      {"forget: {rules: [{older_then: 3d}]}", "older_than"},
      {"forget: {rules: [{older_than: 3}]}", "older_than"},
      {"forget: {rules: [{match: a/b/c/d/e, older_than: 3d}]}", "match"},
      {"forget: {rules: [{read_less_than: 0}]}", "1 or more"},
      {"forget: {rules: [{importance: {below: high}}]}", "below"},
      {"forget: {rules: [{saliency: {keep: 2}}]}", "needs 0 to 1"},
      {"forget: {rules: [{saliency: {keep: .nan}}]}", "keep"},
      {"forget: {rules: [{saliency: {below: 0.1, keep: 0.1}}]}", "both 'below' and 'keep'"},
      {"forget: {rules: [{saliency: {above: 0.1}}]}", "above"},
      {"forget: {rules: [{redundant: {numbers: {measure: rms, bound: -1}}}]}", "bound"},
      {"forget: {rules: [{redundant: {max_gap: 0s}}]}", "max_gap"},
      {"forget: {quota: {}}", "max_bytes"},
      {"forget: {quota: {first: [{redundant: {}}]}}", "max_bytes"},
      {"forget: {quota: {max_bytes: 12}}", "max_bytes"},
      {"forget: {quota: {max_bytes: 1B, most_bytes: 1B}}", "stands beside 'max_bytes'"},
      {"forget: {protect: {newest: -1}}", "0 or more"},
      {"forget: {protect: {linked: maybe}}", "linked"},
      {"forget: {protect: {match: Grasp}}", "match"},
  };
  for (const auto& each : cases) {
    SCOPED_TRACE(each.text);
    EXPECT_FAILS(parse(each.text), StatusCode::kInvalidArgument, each.part);
    EXPECT_THAT(parse(each.text).status().message(), HasSubstr("f.yaml:"));
  }
}

TEST(ForgetConfig, TheExampleOfTheDocumentationIsOne) {
  std::ifstream file(ENGRAM_SOURCE_DIR "/docs/forgetting.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  const std::string begin = "```yaml\n";
  const size_t at = page.find(begin);
  ASSERT_NE(at, std::string::npos);
  const size_t from = at + begin.size();
  const auto options = parse(page.substr(from, page.find("```", from) - from));
  ASSERT_OK(options);
  EXPECT_THAT(options->rules, SizeIs(4));
}

TEST(ForgetConfig, NamesAMissingFile) {
  EXPECT_FAILS(read_forget_config("/nowhere/robot.yaml"), StatusCode::kNotFound, "robot.yaml");
}

}  // namespace
}  // namespace engram::ltm
