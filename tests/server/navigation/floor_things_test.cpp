// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/floor_things.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/ltm/expect_status.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::navigation {
namespace {

using std::chrono::seconds;
using testing::class_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kBegin;
using ::testing::SizeIs;
using testing::surface_at;
using testing::thing_at;

std::vector<std::string> names(const FloorThings& things) {
  std::vector<std::string> names;
  for (const Obstacle& obstacle : things.obstacles()) names.push_back(obstacle.name);
  return names;
}

FloorThings furnished() {
  FloorThings things = FloorThings::create({}).value();
  things.take(surface_at("table", {2, 0, 0}, 0.75, 0.8, 1.4));
  things.take(class_of("chair", "box", 0.45, 0.5, 0.9));
  things.take(class_of("salt", "cylinder", 0.05, 0.05, 0.1));
  things.take(class_of("person", "cylinder", 0.5, 0.5, 1.7));
  return things;
}

TEST(FloorThings, KnowsFurnitureAndWhatStandsOnTheFloor) {
  FloorThings things = furnished();
  EXPECT_TRUE(things.take(thing_at("chair_1", "chair", {1, 1, 0.5}, 0.45, kBegin)));
  EXPECT_TRUE(things.take(thing_at("person_1", "person", {-1, 1, 0}, 0.85, kBegin)));
  EXPECT_THAT(names(things), ElementsAre("chair_1", "person_1", "table"));
  const std::vector<Obstacle> found = things.obstacles();
  EXPECT_EQ(found[0].shape, Obstacle::Shape::kBox);
  EXPECT_NEAR(found[0].pose_world_obstacle.heading_rad, 0.5, 1e-12);
  EXPECT_NEAR(found[0].size_m.y(), 0.5, 1e-12);
  EXPECT_EQ(found[0].max_speed_m_s, 0.5);
  EXPECT_EQ(found[0].snapshot, testing::thing_id("chair_1").at(kBegin).instance(0));
  EXPECT_EQ(found[1].shape, Obstacle::Shape::kCylinder);
  EXPECT_EQ(found[1].max_speed_m_s, 1.2);
  EXPECT_NEAR(found[2].size_m.x(), 0.8, 1e-12);
  EXPECT_EQ(found[2].max_speed_m_s, 0);
  EXPECT_THAT(things.take_changes(), SizeIs(3));
  EXPECT_THAT(things.take_changes(), IsEmpty());
}

TEST(FloorThings, IgnoresWhatIsHeldStandsOnFurnitureOrIsFlat) {
  FloorThings things = furnished();
  things.take(class_of("rug", "box", 2, 1, 0.01));
  things.take(class_of("lamp", "box", 0.5, 0.5, 0.4));
  things.take(thing_at("salt_1", "salt", {2.3, 0.5, 0}, 0.8, kBegin));
  things.take(thing_at("salt_2", "salt", {0, 0, 0}, 1.1, kBegin, "left"));
  things.take(thing_at("rug_1", "rug", {0, 0, 0}, 0.005, kBegin));
  things.take(thing_at("lamp_1", "lamp", {0, 0, 0}, 2.5, kBegin));
  EXPECT_THAT(names(things), ElementsAre("table"));
  EXPECT_THAT(things.left_out(), IsEmpty());
  // It falls from the table.
  things.take(thing_at("salt_1", "salt", {1, 0.5, 0}, 0.05, kBegin + seconds(1)));
  EXPECT_THAT(names(things), ElementsAre("salt_1", "table"));
  // The table is carried away from below another thing, and back.
  things.take(thing_at("salt_3", "salt", {2, 0, 0}, 0.8, kBegin));
  things.take(surface_at("table", {-3, 0, 0}, 0.75, 0.8, 1.4, kBegin + seconds(2)));
  EXPECT_THAT(names(things), ElementsAre("salt_1", "salt_3", "table"));
}

TEST(FloorThings, SaysWhatItLeavesOutAndWhy) {
  FloorThings things = furnished();
  ltm::Snapshot classless = thing_at("thing_1", "chair", {0, 0, 0}, 0.1, kBegin);
  *classless.instances[0].data.at("object_class") = "";
  things.take(classless);
  things.take(thing_at("thing_2", "unheard", {0, 0, 0}, 0.1, kBegin));
  ltm::Snapshot placeless = thing_at("thing_3", "chair", {0, 0, 0}, 0.1, kBegin);
  *placeless.instances[0].data.at("pose_world_object/position") =
      idf::NdArray::take<double>({3}, {std::nan(""), 0, 0});
  things.take(placeless);
  ltm::Snapshot turned = thing_at("thing_4", "chair", {0, 0, 0}, 0.1, kBegin);
  *turned.instances[0].data.at("pose_world_object/orientation") =
      idf::NdArray::take<double>({4}, {2, 0, 0, 0});
  things.take(turned);
  const std::vector<LeftOutThing> left_out = things.left_out();
  ASSERT_THAT(left_out, SizeIs(4));
  EXPECT_THAT(left_out[0].reason, HasSubstr("has no class"));
  EXPECT_THAT(left_out[1].reason, HasSubstr("'Objects/Classes/kitchen/unheard' is not known"));
  EXPECT_THAT(left_out[2].reason, HasSubstr("no pose of finite numbers"));
  EXPECT_THAT(left_out[3].reason, HasSubstr("norm of 2"));
  // Its class comes later.
  things.take(class_of("unheard", "box", 1, 1, 1));
  EXPECT_THAT(things.left_out(), SizeIs(3));
  EXPECT_THAT(names(things), ElementsAre("thing_2", "table"));
}

TEST(FloorThings, TellsOfWhatItLeavesOutAsOfAChange) {
  FloorThings things = furnished();
  EXPECT_THAT(things.take_changes(), SizeIs(1));
  things.take(thing_at("box_1", "unheard", {0, 0, 0}, 0.1, kBegin));
  const auto changes = things.take_changes();
  ASSERT_THAT(changes, SizeIs(1));
  EXPECT_EQ(changes[0].entity, testing::thing_id("box_1"));
  EXPECT_FALSE(changes[0].obstacle.has_value());
  // The same reason again is none.
  things.take(thing_at("box_1", "unheard", {1, 0, 0}, 0.1, kBegin + seconds(1)));
  EXPECT_THAT(things.take_changes(), IsEmpty());
}

TEST(FloorThings, LooksAnewAtWhatStandsOnFurnitureWhenThatIsRaised) {
  FloorThings things = furnished();
  things.take(thing_at("salt_1", "salt", {2, 0.5, 0}, 0.8, kBegin));
  EXPECT_THAT(names(things), ElementsAre("table"));
  EXPECT_THAT(things.take_changes(), SizeIs(1));
  // The table is raised, and the salt is below it now.
  things.take(surface_at("table", {2, 0, 0}, 1.1, 0.8, 1.4, kBegin + seconds(1)));
  EXPECT_THAT(names(things), ElementsAre("salt_1", "table"));
  EXPECT_THAT(things.take_changes(), SizeIs(1));
  // It comes down in steps of less than a millimetre.
  for (int i = 1; i <= 700; ++i)
    things.take(surface_at("table", {2, 0, 0}, 1.1 - 0.0005 * i, 0.8, 1.4,
                           kBegin + seconds(1) + std::chrono::milliseconds(i)));
  EXPECT_THAT(names(things), ElementsAre("table"));
}

TEST(FloorThings, SmallStepsAddUpToAChange) {
  FloorThings things = furnished();
  things.take(thing_at("chair_1", "chair", {1, 1, 0}, 0.45, kBegin));
  EXPECT_THAT(things.take_changes(), SizeIs(2));
  size_t changes = 0;
  for (int i = 1; i <= 10; ++i) {
    things.take(thing_at("chair_1", "chair", {1 + i * 0.0004, 1, 0}, 0.45, kBegin + seconds(i)));
    changes += things.take_changes().size();
  }
  EXPECT_EQ(changes, 3U);
  EXPECT_EQ(things.obstacles().front().snapshot.time(), kBegin + seconds(10));
}

TEST(FloorThings, DoesNotGoBackInTime) {
  FloorThings things = furnished();
  things.take(thing_at("chair_1", "chair", {1, 1, 0}, 0.45, kBegin + seconds(1)));
  things.take(thing_at("chair_1", "chair", {2, 2, 0}, 0.45, kBegin));
  EXPECT_EQ(things.obstacles().front().pose_world_obstacle.x_m, 1);
  EXPECT_EQ(things.newest(), kBegin + seconds(1));
}

TEST(FloorThings, TakesTheOutlineOfWhatLies) {
  FloorThings things = furnished();
  ltm::Snapshot fallen = thing_at("person_1", "person", {0, 0, 0}, 0.25, kBegin);
  // Turned about the y axis by a quarter, its length lies along x.
  const double half = std::sqrt(0.5);
  *fallen.instances[0].data.at("pose_world_object/orientation") =
      idf::NdArray::take<double>({4}, {half, 0, half, 0});
  things.take(fallen);
  const Obstacle person = things.obstacles().front();
  EXPECT_EQ(person.shape, Obstacle::Shape::kBox);
  EXPECT_NEAR(person.size_m.maxCoeff(), 1.7, 1e-9);
  EXPECT_NEAR(person.size_m.minCoeff(), 0.5, 1e-9);
}

TEST(FloorThings, GoesByItsRules) {
  MapRules rules;
  rules.ignored = {"toy.*"};
  rules.speeds = {{"cat", 3}};
  FloorThings things = FloorThings::create(rules).value();
  things.take(class_of("chair", "box", 0.45, 0.5, 0.9));
  things.take(thing_at("toy_7", "chair", {0, 0, 0}, 0.45, kBegin));
  things.take(thing_at("cat", "chair", {0, 0, 0}, 0.45, kBegin));
  EXPECT_THAT(names(things), ElementsAre("cat"));
  EXPECT_EQ(things.obstacles().front().max_speed_m_s, 3);
  EXPECT_FALSE(
      things.take({*ltm::MemoryId::parse("Speech/Commands/human/text"), kBegin, {{{}, {}}}}));
  rules.speeds = {{"cat", -1}};
  EXPECT_FAILS(FloorThings::create(rules), StatusCode::kInvalidArgument, "max_speed of 'cat'");
}

}  // namespace
}  // namespace engram::navigation
