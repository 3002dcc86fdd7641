// SPDX-License-Identifier: Apache-2.0
#include <engram/v1/kitchen_body.pb.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/kitchen/kitchen_skills.h"
#include "server/kitchen/body_client.h"
#include "server/kitchen/body_messages.h"
#include "server/kitchen/body_rpc.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

namespace kitchen = datasets::kitchen;
using kitchen::BodyCommand;
using kitchen::Side;

kitchen::BodyState some_state() {
  kitchen::BodyState state;
  state.sample = 7;
  for (int i = 0; i < kitchen::kRobotJoints; ++i) {
    state.positions[i] = 0.1 * i;
    state.velocities[i] = -0.3 * i;
  }
  state.pose_world_left_hand.translation() << 1, 2, 3;
  kitchen::SensedObject object{.name = "salt_box", .is_visible = true, .held_by = "left"};
  object.pose.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  state.objects = {object};
  state.has_news = true;
  state.images_until = 6;
  state.blocked_by = "chair";
  return state;
}

TEST(KitchenBus, CarriesStatesAndCommandsExactly) {
  const kitchen::BodyState state = some_state();
  const auto read = read_state(to_message(state));
  ASSERT_OK(read);
  EXPECT_EQ(read->sample, 7u);
  EXPECT_EQ(read->positions, state.positions);
  EXPECT_EQ(read->velocities, state.velocities);
  EXPECT_EQ(read->pose_world_left_hand.matrix(), state.pose_world_left_hand.matrix());
  ASSERT_EQ(read->objects.size(), 1u);
  EXPECT_EQ(read->objects[0].pose.matrix(), state.objects[0].pose.matrix());
  EXPECT_EQ(read->objects[0].held_by, "left");
  EXPECT_TRUE(read->has_news);
  EXPECT_EQ(read->images_until, 6u);
  EXPECT_EQ(read->blocked_by, "chair");

  kitchen::MoveHand hand{.hand = Side::kLeft, .seconds = 2};
  hand.pose_world_hand.translation() << 0.1, 0.2, 0.3;
  const std::vector<BodyCommand> commands{kitchen::MoveJoints{{4, 5}, {0.5, -0.5}, 2},
                                          hand,
                                          kitchen::LookAt{"salt", {1, 2, 3}},
                                          kitchen::DriveTo{{1, 2, 3}, 4},
                                          kitchen::Drive{{0.1, 0, 0.2}},
                                          kitchen::Hold{Side::kLeft, "salt", {1, 2, 3}},
                                          kitchen::Release{Side::kLeft},
                                          kitchen::StopAll{}};
  for (const BodyCommand& command : commands) {
    const auto message = to_message(command);
    const auto again = read_command(message);
    ASSERT_OK(again);
    EXPECT_EQ(again->index(), command.index());
    EXPECT_EQ(to_message(*again).SerializeAsString(), message.SerializeAsString());
  }
}

TEST(KitchenBus, RefusesMessagesThatDoNotFit) {
  EXPECT_FAILS(read_command({}), StatusCode::kInvalidArgument, "does not know");
  auto state = to_message(some_state());
  state.mutable_positions()->RemoveLast();
  EXPECT_FAILS(read_state(state), StatusCode::kInvalidArgument, "positions has 45 numbers");
  state = to_message(some_state());
  state.set_velocities(3, std::numeric_limits<double>::infinity());
  EXPECT_FAILS(read_state(state), StatusCode::kInvalidArgument, "not finite");
  state = to_message(some_state());
  state.mutable_objects(0)->clear_pose();
  EXPECT_FAILS(read_state(state), StatusCode::kInvalidArgument, "object has 0 numbers");
  v1::BodyCommandRequest drive;
  drive.mutable_drive()->add_velocity(1);
  EXPECT_FAILS(read_command(drive), StatusCode::kInvalidArgument, "velocity has 1 numbers");
  v1::BodyDrawReply picture;
  EXPECT_FAILS(read_picture(picture), StatusCode::kInvalidArgument, "0 x 0");
  picture.set_width(1 << 30);
  picture.set_height(1 << 30);
  EXPECT_FAILS(read_picture(picture), StatusCode::kInvalidArgument, "needs 1 to 4096");
  picture.set_width(2);
  picture.set_height(2);
  picture.set_left("12");
  EXPECT_FAILS(read_picture(picture), StatusCode::kInvalidArgument, "2 and 0 bytes, needs 12");
  EXPECT_FAILS(read_description({}), StatusCode::kInvalidArgument, "images of 0 x 0");
  v1::BodyDescription body;
  body.set_width(2);
  body.set_height(2);
  EXPECT_FAILS(read_description(body), StatusCode::kInvalidArgument, "lower has 0 numbers");
  body.set_start_ns(-1);
  EXPECT_FAILS(read_description(body), StatusCode::kInvalidArgument, "a start at -1 ns");
  body.set_start_ns(0);
  body.set_begin(~uint64_t{0});
  EXPECT_FAILS(read_description(body), StatusCode::kInvalidArgument, "sample 18446744073709551615");
  state = to_message(some_state());
  state.set_images_until(uint64_t{1} << 63);
  EXPECT_FAILS(read_state(state), StatusCode::kInvalidArgument, "images of a state");
  v1::BodyStepRequest step;
  step.set_step(static_cast<v1::BodyStepRequest::Step>(77));
  EXPECT_FAILS(read_step(step), StatusCode::kInvalidArgument, "step 77");
  v1::BodyPassRequest pass;
  pass.set_samples(~uint64_t{0});
  EXPECT_FAILS(read_wish(pass), StatusCode::kInvalidArgument, "samples to pass");
}

TEST(KitchenBus, LetsAnotherProcessMoveTheRobot) {
  kitchen::LiveBody::Options options;
  options.kitchen = datasets::KitchenOptions::fast();
  options.kitchen.width = 64;
  options.kitchen.height = 32;
  options.is_stepped = true;
  options.clients = {"skills"};
  auto body = kitchen::LiveBody::start(options);
  ASSERT_OK(body);
  const ScratchDirectory directory;
  const auto endpoint = Endpoint::parse("unix:" + (directory / "bus.sock").string());
  ASSERT_OK(endpoint);
  auto server = BodyServer::start(**body, *endpoint);
  ASSERT_OK(server);
  const auto bus = connect_body(*endpoint, "skills");
  ASSERT_OK(bus);
  const auto about = (*bus)->describe();
  ASSERT_OK(about);
  EXPECT_EQ(about->width, 64);
  EXPECT_EQ(about->lower.size(), 43u);
  EXPECT_EQ(about->pose_head_left.matrix(), (*body)->describe().pose_head_left.matrix());
  const auto picture = (*bus)->draw(5, 0, {});
  ASSERT_OK(picture);
  EXPECT_EQ(picture->sample, 5u);
  EXPECT_EQ(picture->left.shape(), (idf::Shape{32, 64, 3}));
  const auto driven = kitchen::KitchenSkills(**bus).navigate(
      {.object = {}, .place = Eigen::Vector3d(-0.3, 0.4, 2.0)}, {});
  ASSERT_OK(driven);
  EXPECT_EQ(driven->end, kitchen::SkillEnd::kSuccess) << driven->reason;
  EXPECT_FAILS((*bus)->poke("dog to 1,1"), StatusCode::kNotFound, "no 'dog'");
  EXPECT_OK((*bus)->poke("chair to 1,0"));
  EXPECT_FAILS((*bus)->command(kitchen::Drive{{NAN, 0, 0}}), StatusCode::kInvalidArgument,
               "not finite");
  EXPECT_FAILS((*bus)->draw(0, 1'000'000, {}), StatusCode::kInvalidArgument,
               "committed images until 1000000");
  const auto now = (*bus)->now();
  ASSERT_OK(now);
  EXPECT_EQ((*body)->now().sample, now->sample);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS((*bus)->wait(1'000'000, stop.get_token()), StatusCode::kCancelled, "stopped");
  server->reset();
  EXPECT_FAILS((*bus)->describe(), StatusCode::kUnavailable, "no live kitchen at");
}

TEST(KitchenBus, ListensOnUnixSocketsAlone) {
  const auto endpoint = Endpoint::parse("127.0.0.1:0");
  ASSERT_OK(endpoint);
  EXPECT_FAILS(connect_body(*endpoint, "one"), StatusCode::kInvalidArgument, "Unix socket");
}

}  // namespace
}  // namespace engram::server
