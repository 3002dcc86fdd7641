// SPDX-License-Identifier: Apache-2.0
#include "viewer/forget_form.h"

#include "tests/ltm/expect_status.h"

namespace engram::viewer {
namespace {

Result<ForgetPolicyText> policy_of(const std::string& query) {
  const auto target = RequestTarget::parse("/api/forgetting?" + query);
  EXPECT_OK(target);
  return read_forget_policy(*target);
}

TEST(ForgetPolicyText, IsTheConfigurationThatAFormMeans) {
  const auto policy = policy_of(
      "match=Vision/.*&older_than=30d&keep=0.2&fade_after=7d&fade_psnr=32&max_bytes=2GB&"
      "newest=5&unread_for=");
  ASSERT_OK(policy);
  EXPECT_EQ(policy->config, R"(forget:
  rules:
    - {match: 'Vision/.*', older_than: 30d, saliency: {keep: 0.2}}
  fade:
    - {match: 'Vision/.*', after: 7d, psnr: 32}
  quota:
    max_bytes: 2GB
    first:
      - {match: 'Vision/.*', older_than: 0s}
  protect:
    newest: 5
)");
  ASSERT_EQ(policy->options.rules.size(), 1u);
  EXPECT_EQ(policy->options.rules[0].age->older_than, std::chrono::hours(24 * 30));
  EXPECT_EQ(policy->options.rules[0].saliency->keep, 0.2);
  ASSERT_EQ(policy->options.fade.size(), 1u);
  EXPECT_EQ(policy->options.fade[0].psnr_db, 32);
  EXPECT_EQ(policy->options.max_bytes, 2'000'000'000u);
  EXPECT_EQ(policy->options.protection.newest, 5u);
}

TEST(ForgetPolicyText, KeepsNamesWhatTheyAre) {
  const auto policy = policy_of("match=it%27s%3A%20%7Bx%7D/%23&fade_after=1d&fade_psnr=gist");
  ASSERT_OK(policy);
  EXPECT_EQ(policy->options.fade[0].rule.match.to_string(), "it's: {x}/#");
  EXPECT_EQ(policy->options.fade[0].psnr_db, std::nullopt);
}

TEST(ForgetPolicyText, NamesTheFieldThatIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {
      {"older_than=soon", "parameter 'older_than': found 'soon', needs a duration"},
      {"older_than=1d%20}", "parameter 'older_than'"},
      {"unread_for=-1d", "parameter 'unread_for'"},
      {"keep=1.5", "parameter 'keep': found '1.5', needs a number from 0 to 1"},
      {"keep=1e-1", "parameter 'keep'"},
      {"keep=inf", "parameter 'keep'"},
      {"max_bytes=2", "parameter 'max_bytes': found '2', needs a size"},
      {"max_bytes=1GB%0A", "parameter 'max_bytes'"},
      {"older_than=1d&newest=0.5", "parameter 'newest': found '0.5', needs an integer"},
      {"fade_psnr=20", "parameter 'fade_psnr': found '20', needs 'fade_after' beside it"},
      {"fade_after=1d&fade_psnr=5", "needs a number from 15 to 60"},
      {"older_than=1d&match=(", "parameter 'match'"},
      {"older_than=1d&match=a%0Ab", "parameter 'match'"},
      {"config=forget%3A%20{}&keep=1", "parameter 'keep': found it beside 'config'"},
      {"config=forget%3A%20[]", "policy:1: "},
      {"newest=3", "nothing says what is to go"},
      {"", "nothing says what is to go"}};
  for (const auto& [query, needed] : wrong)
    EXPECT_FAILS(policy_of(query), StatusCode::kInvalidArgument, needed);
}

}  // namespace
}  // namespace engram::viewer
