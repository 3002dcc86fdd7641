// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/task_words.h"

#include <gtest/gtest.h>

#include "speech/noticing/hand_joints.h"

namespace engram::speech {
namespace {

TEST(TaskWords, ReadWhatPeopleWriteForRobots) {
  const auto expect = [](const char* text, const char* skill, const char* thing,
                         const char* place) {
    const TaskWords words = task_words(text);
    EXPECT_EQ(words.skill, skill) << text;
    EXPECT_EQ(words.thing, thing) << text;
    EXPECT_EQ(words.place, place) << text;
  };
  expect("Pick up the yellow bottle on the table.", "pick", "yellow bottle", "table");
  expect("put the red cup into the box", "place", "red cup", "box");
  expect("Grasp bottle", "pick", "bottle", "");
  expect("Please take a bottle of water from the top shelf", "pick", "bottle", "top shelf");
  expect("pick the lego block with your left hand", "pick", "lego block", "");
  expect("Pick the cup up and place it in the bin.", "pick", "cup", "");
  expect("Set the plate down next to the sink", "place", "plate", "sink");
  expect("fold towel, then stack it", "fold", "towel", "");
  expect("OPEN THE DRAWER!", "open", "drawer", "");
  expect("Dance.", "dance", "", "");
}

TEST(TaskWords, EndureAnything) {
  for (const char* text : {"", "   ", "...", "the the the", "of of", "\xff\xfe\x80", "pick"})
    EXPECT_LE(task_words(text).thing.size(), 60u) << text;
  EXPECT_EQ(task_words("pick up the"), (TaskWords{"pick", "", ""}));
  const TaskWords words = task_words("pick the " + std::string(100'000, 'x') + " thing");
  EXPECT_LE(words.thing.size(), 60u);
  EXPECT_EQ(entity_name("caf\xc3\xa9/../x"), "caf______x");
}

TEST(HandJoints, AreFoundByTheirNames) {
  const auto hands =
      hands_among({"kLeftElbow", "kLeftHandIndex", "kRightHandMiddle", "right_index_1",
                   "kRightWristRoll", "waist_string", "kRightHandThumbBend"});
  ASSERT_EQ(hands.size(), 2u);
  EXPECT_EQ(hands[0].hand, "left");
  EXPECT_EQ(hands[0].columns, (std::vector<size_t>{1}));
  EXPECT_EQ(hands[1].columns, (std::vector<size_t>{2, 3}));
  EXPECT_EQ(hands_among({"left_thumb_1"})[0].columns, (std::vector<size_t>{0}));
  const auto gripper = hands_among({"shoulder_pan.pos", "gripper.pos"});
  ASSERT_EQ(gripper.size(), 1u);
  EXPECT_EQ(gripper[0].hand, "gripper");
  EXPECT_TRUE(gripper[0].is_gripper);
  EXPECT_TRUE(hands_among({}).empty());
}

TEST(HandJoints, ReadNumbersByNamesAndFromArrays) {
  const idf::Data named(idf::Dict{{"left_thumb", 0.5F}, {"left_hand_velocity", 3.0}, {"n", 7}});
  EXPECT_EQ(joint_numbers(named), (std::vector<double>{0.5}));
  EXPECT_EQ(joint_names(named, {}), (std::vector<std::string>{"left_thumb"}));
  const idf::Data array(
      idf::Dict{{"positions", idf::NdArray::take({2}, std::vector<float>{1, 2})},
                {"velocities", idf::NdArray::take({2}, std::vector<float>{3, 4})}});
  EXPECT_EQ(joint_numbers(array), (std::vector<double>{1, 2}));
  EXPECT_EQ(joint_names(array, {"elbow", "left_thumb"})[1], "left_thumb");
  EXPECT_EQ(joint_names(array, {"elbow"})[1], "");
  const auto hands = hands_among(joint_names(array, {"elbow", "left_thumb"}));
  ASSERT_EQ(hands.size(), 1u);
  EXPECT_EQ(mean_of(hands[0], {1, 2}), 2);
  EXPECT_FALSE(mean_of(hands[0], {1}));
  EXPECT_FALSE(mean_of(hands[0], {1, std::nan("")}));
}

}  // namespace
}  // namespace engram::speech
