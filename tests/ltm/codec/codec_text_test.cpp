// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/codec_text.h"

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

TEST(CodecText, ReadsNameAndOptions) {
  auto text = *CodecText::parse("h264:crf=23,group=30");
  EXPECT_EQ(text.name(), "h264");
  EXPECT_EQ(*text.take("crf", true, 1, 0, 51), 23);
  EXPECT_EQ(*text.take("group", false, 1, 1, 100), 30);
  EXPECT_EQ(*text.take("effort", false, 4, 0, 9), 4);
  EXPECT_OK(text.finish());
}

TEST(CodecText, GivesAValueWithoutAKeyToTheMainOption) {
  auto text = *CodecText::parse("h264:20,group=5");
  EXPECT_EQ(*text.take("group", false, 1, 1, 100), 5);
  EXPECT_EQ(*text.take("crf", true, 1, 0, 51), 20);
  EXPECT_OK(text.finish());
}

TEST(CodecText, RefusesWhatIsNoOption) {
  for (const char* wrong : {"", ":3", "png:", "png:x", "png:=3", "png:level=", "png:level=3.5",
                            "png:1,", "png:1,2", "png:level=1,level=1", "png:99999999999"})
    EXPECT_FAILS(CodecText::parse(wrong), StatusCode::kInvalidArgument, "codec");
}

TEST(CodecText, RefusesWhatNobodyTook) {
  auto text = *CodecText::parse("png:level=3,size=4");
  EXPECT_EQ(*text.take("level", true, 1, 0, 9), 3);
  EXPECT_FAILS(text.finish(), StatusCode::kInvalidArgument, "has no option 'size'");
}

TEST(CodecText, RefusesBothAKeyAndAValueForTheMainOption) {
  auto text = *CodecText::parse("png:level=3,4");
  EXPECT_EQ(*text.take("level", true, 1, 0, 9), 3);
  EXPECT_FAILS(text.finish(), StatusCode::kInvalidArgument, "has no option '4'");
}

}  // namespace
}  // namespace engram::ltm
