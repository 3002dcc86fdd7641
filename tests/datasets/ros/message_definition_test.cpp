// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/message_definition.h"

#include "tests/datasets/ros/example_messages.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::ros {
namespace {

TEST(MessageDefinition, FollowsNamesIntoOtherSections) {
  const auto definition = MessageDefinition::parse(
      "tf2_msgs/msg/TFMessage", std::string(kRos1Transforms) + std::string(kRos1Header));
  ASSERT_OK(definition);
  EXPECT_EQ(definition->root().name, "tf2_msgs/TFMessage");
  ASSERT_EQ(definition->root().fields.size(), 1U);
  const Field& transforms = definition->root().fields[0];
  EXPECT_EQ(transforms.multiplicity, Multiplicity::kSequence);
  const Message& stamped = definition->message(transforms.message);
  EXPECT_EQ(stamped.name, "geometry_msgs/TransformStamped");
  ASSERT_EQ(stamped.fields.size(), 3U);
  EXPECT_EQ(stamped.fields[1].name, "child_frame_id");
  EXPECT_EQ(definition->message(stamped.fields[2].message).name, "geometry_msgs/Transform");
}

TEST(MessageDefinition, PassesOverConstantsDefaultsBoundsAndComments) {
  const auto definition = MessageDefinition::parse("a/Mixed", kMixedDefinition);
  ASSERT_OK(definition);
  ASSERT_EQ(definition->root().fields.size(), 11U);
  EXPECT_EQ(definition->root().fields[4].name, "e");
  EXPECT_EQ(definition->root().fields[8].multiplicity, Multiplicity::kFixed);
  EXPECT_EQ(definition->root().fields[8].count, 3U);
  EXPECT_EQ(definition->root().fields[9].multiplicity, Multiplicity::kSequence);
}

TEST(MessageDefinition, NamesWhatItCannotRead) {
  const auto parse = [](std::string_view text) { return MessageDefinition::parse("a/B", text); };
  EXPECT_FAILS(parse("int32"), StatusCode::kInvalidArgument, "needs a type and a name");
  EXPECT_FAILS(parse("int32[x] a"), StatusCode::kInvalidArgument, "needs [], [N] or [<=N]");
  EXPECT_FAILS(parse("int32[99999999999] a"), StatusCode::kInvalidArgument, "no array");
  EXPECT_FAILS(parse("Other a"), StatusCode::kInvalidArgument, "'Other' is defined nowhere");
  EXPECT_FAILS(parse("B a"), StatusCode::kInvalidArgument, "contains itself");
  EXPECT_FAILS(parse("int32 a\nint32 a"), StatusCode::kInvalidArgument, "two fields 'a'");
  EXPECT_FAILS(parse("wstring a"), StatusCode::kInvalidArgument, "wide characters");
  EXPECT_FAILS(parse("int32 a\n========\nint32 b"), StatusCode::kInvalidArgument, "needs 'MSG:");
}

TEST(MessageDefinition, RefusesEndlessNesting) {
  std::string text = "M0 m\n";
  for (int i = 0; i < 100; ++i) text += fmt::format("========\nMSG: a/M{}\nM{} m\n", i, i + 1);
  EXPECT_FAILS(MessageDefinition::parse("a/B", text), StatusCode::kInvalidArgument, "nest 32 deep");
}

}  // namespace
}  // namespace engram::datasets::ros
