// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/codec_choice.h"

#include <set>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

/// As on a machine on which these have no encoder.
CodecCheck without(const std::set<std::string>& codecs) {
  return [codecs](const PackRule& rule) {
    const Status status = PackOptions{.rules = {rule}}.validate();
    if (status.ok() && codecs.contains(rule.codec))
      return failed_precondition("'{}' is not installed", rule.codec);
    return status;
  };
}

Result<PackRule> choose(const std::string& text, const CodecCheck& check,
                        const std::string& journal = "") {
  const auto config = *ConfigValue::parse("codec: " + text, "rec.yaml");
  return choose_codec(*config.map()->require("codec"), {.path = "left", .journal = journal}, check);
}

TEST(CodecChoice, TakesTheFirstOfAListThatIsInstalled) {
  EXPECT_EQ(choose("[h264, h265, jpeg]", without({}))->codec, "h264");
  EXPECT_EQ(choose("[h264, h265, jpeg]", without({"h264"}))->codec, "h265");
  EXPECT_EQ(choose("[h264, h265, jpeg]", without({"h264", "h265"}))->codec, "jpeg");
  EXPECT_EQ(choose("jpeg", without({"h264"}))->codec, "jpeg");
  EXPECT_EQ(choose("[h264, jpeg]", without({}))->path, "left");
}

TEST(CodecChoice, SaysWhatIsMissing) {
  EXPECT_FAILS(choose("[h264, h265]", without({"h264", "h265"})), StatusCode::kInvalidArgument,
               "'h265' is not installed");
  EXPECT_FAILS(choose("h264", without({"h264"})), StatusCode::kInvalidArgument, "rec.yaml:1");
  EXPECT_FAILS(choose("[]", without({})), StatusCode::kInvalidArgument, "needs one or more");
}

TEST(CodecChoice, RefusesAListOfWhichALaterOneMakesNoSense) {
  EXPECT_FAILS(choose("[png, gif]", without({})), StatusCode::kInvalidArgument, "'gif'");
  EXPECT_FAILS(choose("[png, \"jpeg:\"]", without({})), StatusCode::kInvalidArgument, "rec.yaml");
}

TEST(CodecChoice, UsesTheJournalForGroupsAlone) {
  EXPECT_EQ(choose("[h264, \"jpeg:95\"]", without({}), "png")->journal, "png");
  const auto single = choose("[h264, \"jpeg:95\"]", without({"h264"}), "png");
  ASSERT_OK(single);
  EXPECT_EQ(single->codec, "jpeg:95");
  EXPECT_EQ(single->journal, "");
  EXPECT_FAILS(choose("[png, jpeg]", without({}), "png"), StatusCode::kInvalidArgument,
               "that of the journal already");
  EXPECT_FAILS(choose("[h264, png]", without({}), "jpeg"), StatusCode::kInvalidArgument,
               "has loss");
}

}  // namespace
}  // namespace engram::ltm
