// SPDX-License-Identifier: Apache-2.0
#include "server/kitchen/body_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace engram::server {

namespace kitchen = datasets::kitchen;

namespace {

using Doubles = google::protobuf::RepeatedField<double>;
using kitchen::Pose;
using kitchen::Side;

constexpr int kPoseNumbers = 12;
constexpr int kMaxSamplesPerPixel = 64;
constexpr int kMaxSide = 4096;
/// No time before 1970 or after 2200.
constexpr int64_t kMaxStart_ns = int64_t{230} * 365 * 24 * 3600 * 1'000'000'000;
/// Sixty years. Times of samples are computed, and must not overflow.
constexpr uint64_t kMaxSample = uint64_t{60} * 365 * 24 * 3600 * kitchen::RobotBus::kRate_hz;
static_assert(kMaxSample / kitchen::RobotBus::kRate_hz <
              (uint64_t{INT64_MAX} - uint64_t{kMaxStart_ns}) / 1'000'000'000);
constexpr uint64_t kMaxPass = uint64_t{24} * 3600 * kitchen::RobotBus::kRate_hz;

template <typename Vector>
void write_vector(const Vector& from, Doubles& to) {
  to.Assign(from.data(), from.data() + from.size());
}

void write_pose(const Pose& from, Doubles& to) {
  to.Clear();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) to.Add(from.matrix()(row, column));
}

Status check_numbers(const Doubles& from, int count, std::string_view what) {
  if (from.size() != count)
    return invalid_argument("bus: {} has {} numbers, needs {}", what, from.size(), count);
  if (!std::ranges::all_of(from, [](double number) { return std::isfinite(number); }))
    return invalid_argument("bus: {} has a number that is not finite", what);
  return {};
}

template <typename Vector>
Status read_vector(const Doubles& from, std::string_view what, Vector& to) {
  ENGRAM_RETURN_IF_ERROR(check_numbers(from, static_cast<int>(to.size()), what));
  std::ranges::copy(from, to.data());
  return {};
}

Status read_pose(const Doubles& from, std::string_view what, Pose& to) {
  ENGRAM_RETURN_IF_ERROR(check_numbers(from, kPoseNumbers, what));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) to.matrix()(row, column) = from[4 * row + column];
  return {};
}

Status check_finite(double number, std::string_view what) {
  if (std::isfinite(number)) return {};
  return invalid_argument("bus: {} is not finite", what);
}

Side side_of(bool is_left) {
  return is_left ? Side::kLeft : Side::kRight;
}

/// Writes each command to its member of the message.
struct CommandWriter {
  v1::BodyCommandRequest& to;

  void operator()(const kitchen::MoveJoints& one) const {
    auto& message = *to.mutable_move_joints();
    message.mutable_joints()->Assign(one.joints.begin(), one.joints.end());
    write_vector(one.to, *message.mutable_to());
    message.set_seconds(one.seconds);
  }
  void operator()(const kitchen::MoveHand& one) const {
    auto& message = *to.mutable_move_hand();
    message.set_is_left(one.hand == Side::kLeft);
    write_pose(one.pose_world_hand, *message.mutable_pose());
    message.set_seconds(one.seconds);
  }
  void operator()(const kitchen::LookAt& one) const {
    to.mutable_look_at()->set_object(one.object);
    write_vector(one.point, *to.mutable_look_at()->mutable_point());
  }
  void operator()(const kitchen::DriveTo& one) const {
    write_vector(one.pose, *to.mutable_drive_to()->mutable_pose());
    to.mutable_drive_to()->set_seconds(one.seconds);
  }
  void operator()(const kitchen::Drive& one) const {
    write_vector(one.velocity, *to.mutable_drive()->mutable_velocity());
  }
  void operator()(const kitchen::Hold& one) const {
    to.mutable_hold()->set_is_left(one.hand == Side::kLeft);
    to.mutable_hold()->set_object(one.object);
    write_vector(one.grasp_object, *to.mutable_hold()->mutable_grasp());
  }
  void operator()(const kitchen::Release& one) const {
    to.mutable_release()->set_is_left(one.hand == Side::kLeft);
  }
  void operator()(const kitchen::StopAll& /*one*/) const { to.mutable_stop_all(); }
};

}  // namespace

v1::BodyDescription to_message(const kitchen::BodyDescription& body) {
  v1::BodyDescription message;
  message.set_seed(body.seed);
  message.set_start_ns(body.start.time_since_epoch().count());
  message.set_seconds(body.seconds);
  message.set_is_stepped(body.is_stepped);
  message.set_is_held(body.is_held);
  message.set_begin(body.begin);
  message.set_width(body.width);
  message.set_height(body.height);
  message.set_samples_per_pixel(body.samples);
  message.set_lamp(body.lamp);
  message.set_daylight(body.daylight);
  message.set_warmth(body.warmth);
  write_vector(body.lower, *message.mutable_lower());
  write_vector(body.upper, *message.mutable_upper());
  message.set_urdf(body.urdf);
  write_pose(body.pose_head_left, *message.mutable_pose_head_left());
  write_pose(body.pose_head_right, *message.mutable_pose_head_right());
  return message;
}

Result<kitchen::BodyDescription> read_description(const v1::BodyDescription& message) {
  kitchen::BodyDescription body;
  body.seed = message.seed();
  if (message.start_ns() < 0 || message.start_ns() > kMaxStart_ns)
    return invalid_argument("bus: a start at {} ns, needs 0 to {}", message.start_ns(),
                            kMaxStart_ns);
  body.start = time_from_ns(message.start_ns());
  body.seconds = message.seconds();
  body.is_stepped = message.is_stepped();
  body.is_held = message.is_held();
  ENGRAM_ASSIGN_OR_RETURN(body.begin, read_sample(message.begin(), "the begin"));
  body.width = message.width();
  body.height = message.height();
  body.samples = message.samples_per_pixel();
  body.lamp = message.lamp();
  body.daylight = message.daylight();
  body.warmth = message.warmth();
  for (const auto& [number, what] : {std::pair{body.seconds, "seconds"},
                                     {body.lamp, "lamp"},
                                     {body.daylight, "daylight"},
                                     {body.warmth, "warmth"}})
    ENGRAM_RETURN_IF_ERROR(check_finite(number, what));
  if (body.width < 1 || body.height < 1 || body.width > kMaxSide || body.height > kMaxSide)
    return invalid_argument("bus: images of {} x {}, needs 1 to {}", body.width, body.height,
                            kMaxSide);
  if (body.samples < 0 || body.samples > kMaxSamplesPerPixel)
    return invalid_argument("bus: {} samples per pixel, needs 0 to {}", body.samples,
                            kMaxSamplesPerPixel);
  body.lower.resize(kitchen::kJoints);
  body.upper.resize(kitchen::kJoints);
  ENGRAM_RETURN_IF_ERROR(read_vector(message.lower(), "lower", body.lower));
  ENGRAM_RETURN_IF_ERROR(read_vector(message.upper(), "upper", body.upper));
  body.urdf = message.urdf();
  ENGRAM_RETURN_IF_ERROR(
      read_pose(message.pose_head_left(), "pose_head_left", body.pose_head_left));
  ENGRAM_RETURN_IF_ERROR(
      read_pose(message.pose_head_right(), "pose_head_right", body.pose_head_right));
  return body;
}

v1::BodyState to_message(const kitchen::BodyState& state) {
  v1::BodyState message;
  message.set_sample(state.sample);
  write_vector(state.positions, *message.mutable_positions());
  write_vector(state.velocities, *message.mutable_velocities());
  write_pose(state.pose_world_left_hand, *message.mutable_pose_left_hand());
  write_pose(state.pose_world_right_hand, *message.mutable_pose_right_hand());
  for (const kitchen::SensedObject& object : state.objects) {
    v1::SensedObject& one = *message.add_objects();
    one.set_name(object.name);
    write_pose(object.pose, *one.mutable_pose());
    one.set_is_visible(object.is_visible);
    one.set_held_by(object.held_by);
  }
  message.set_has_news(state.has_news);
  message.set_images_until(state.images_until);
  message.set_blocked_by(state.blocked_by);
  return message;
}

Result<kitchen::BodyState> read_state(const v1::BodyState& message) {
  kitchen::BodyState state;
  ENGRAM_ASSIGN_OR_RETURN(state.sample, read_sample(message.sample(), "a state"));
  ENGRAM_ASSIGN_OR_RETURN(state.images_until,
                          read_sample(message.images_until(), "the images of a state"));
  ENGRAM_RETURN_IF_ERROR(read_vector(message.positions(), "positions", state.positions));
  ENGRAM_RETURN_IF_ERROR(read_vector(message.velocities(), "velocities", state.velocities));
  ENGRAM_RETURN_IF_ERROR(
      read_pose(message.pose_left_hand(), "pose_left_hand", state.pose_world_left_hand));
  ENGRAM_RETURN_IF_ERROR(
      read_pose(message.pose_right_hand(), "pose_right_hand", state.pose_world_right_hand));
  for (const v1::SensedObject& one : message.objects()) {
    kitchen::SensedObject object;
    object.name = one.name();
    ENGRAM_RETURN_IF_ERROR(read_pose(one.pose(), "the pose of an object", object.pose));
    object.is_visible = one.is_visible();
    object.held_by = one.held_by();
    state.objects.push_back(std::move(object));
  }
  state.has_news = message.has_news();
  state.blocked_by = message.blocked_by();
  return state;
}

v1::BodyDrawReply to_message(const kitchen::BodyPicture& picture) {
  v1::BodyDrawReply message;
  message.set_is_drawn(true);
  message.set_sample(picture.sample);
  message.set_height(static_cast<int32_t>(picture.left.shape()[0]));
  message.set_width(static_cast<int32_t>(picture.left.shape()[1]));
  const auto write = [](const idf::NdArray& image, std::string& to) {
    const auto pixels = image.values<uint8_t>();
    to.assign(reinterpret_cast<const char*>(pixels.data()), pixels.size());
  };
  write(picture.left, *message.mutable_left());
  write(picture.right, *message.mutable_right());
  write_pose(picture.pose_world_left, *message.mutable_pose_left());
  write_pose(picture.pose_world_right, *message.mutable_pose_right());
  return message;
}

Result<kitchen::BodyPicture> read_picture(const v1::BodyDrawReply& message) {
  kitchen::BodyPicture picture;
  ENGRAM_ASSIGN_OR_RETURN(picture.sample, read_sample(message.sample(), "a picture"));
  const int width = message.width();
  const int height = message.height();
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    return invalid_argument("bus: an image of {} x {}, needs 1 to {}", width, height, kMaxSide);
  const size_t bytes = size_t{3} * static_cast<size_t>(width) * static_cast<size_t>(height);
  if (message.left().size() != bytes || message.right().size() != bytes)
    return invalid_argument("bus: images of {} and {} bytes, needs {}", message.left().size(),
                            message.right().size(), bytes);
  const auto read = [&](const std::string& from) {
    std::vector<uint8_t> pixels(bytes);
    std::memcpy(pixels.data(), from.data(), bytes);
    return idf::NdArray::take({height, width, 3}, std::move(pixels));
  };
  picture.left = read(message.left());
  picture.right = read(message.right());
  ENGRAM_RETURN_IF_ERROR(read_pose(message.pose_left(), "pose_left", picture.pose_world_left));
  ENGRAM_RETURN_IF_ERROR(read_pose(message.pose_right(), "pose_right", picture.pose_world_right));
  return picture;
}

v1::BodyStepRequest to_message(kitchen::SkillStep step) {
  v1::BodyStepRequest message;
  message.set_step(static_cast<v1::BodyStepRequest::Step>(step));
  return message;
}

v1::BodyPassRequest to_message(const kitchen::PassWish& wish) {
  v1::BodyPassRequest message;
  message.set_id(wish.id);
  message.set_samples(wish.samples);
  message.set_until_end(wish.until_end);
  return message;
}

Result<kitchen::SkillStep> read_step(const v1::BodyStepRequest& message) {
  switch (message.step()) {
    case v1::BodyStepRequest::COME:
      return kitchen::SkillStep::kCome;
    case v1::BodyStepRequest::READY:
      return kitchen::SkillStep::kReady;
    case v1::BodyStepRequest::BEGIN:
      return kitchen::SkillStep::kBegin;
    case v1::BodyStepRequest::END:
      return kitchen::SkillStep::kEnd;
    default:
      return invalid_argument("bus: found the step {}, which this body does not know",
                              static_cast<int>(message.step()));
  }
}

Result<kitchen::PassWish> read_wish(const v1::BodyPassRequest& message) {
  if (message.samples() > kMaxPass)
    return invalid_argument("bus: found {} samples to pass, needs {} at most", message.samples(),
                            kMaxPass);
  return kitchen::PassWish{message.id(), message.samples(), message.until_end()};
}

Result<uint64_t> read_sample(uint64_t sample, std::string_view what) {
  if (sample <= kMaxSample) return sample;
  return invalid_argument("bus: {} is of sample {}, needs {} at most", what, sample, kMaxSample);
}

v1::BodyCommandRequest to_message(const kitchen::BodyCommand& command) {
  v1::BodyCommandRequest message;
  std::visit(CommandWriter{message}, command);
  return message;
}

Result<kitchen::BodyCommand> read_command(const v1::BodyCommandRequest& message) {
  using Kind = v1::BodyCommandRequest::CommandCase;
  switch (message.command_case()) {
    case Kind::kMoveJoints: {
      const auto& from = message.move_joints();
      return kitchen::BodyCommand(
          kitchen::MoveJoints{.joints = {from.joints().begin(), from.joints().end()},
                              .to = {from.to().begin(), from.to().end()},
                              .seconds = from.seconds()});
    }
    case Kind::kMoveHand: {
      kitchen::MoveHand one{.hand = side_of(message.move_hand().is_left()),
                            .seconds = message.move_hand().seconds()};
      ENGRAM_RETURN_IF_ERROR(
          read_pose(message.move_hand().pose(), "the pose of a hand", one.pose_world_hand));
      return kitchen::BodyCommand(one);
    }
    case Kind::kLookAt: {
      kitchen::LookAt one{.object = message.look_at().object()};
      ENGRAM_RETURN_IF_ERROR(read_vector(message.look_at().point(), "the point", one.point));
      return kitchen::BodyCommand(one);
    }
    case Kind::kDriveTo: {
      kitchen::DriveTo one{.seconds = message.drive_to().seconds()};
      ENGRAM_RETURN_IF_ERROR(read_vector(message.drive_to().pose(), "the pose", one.pose));
      return kitchen::BodyCommand(one);
    }
    case Kind::kDrive: {
      kitchen::Drive one;
      ENGRAM_RETURN_IF_ERROR(read_vector(message.drive().velocity(), "the velocity", one.velocity));
      return kitchen::BodyCommand(one);
    }
    case Kind::kHold: {
      kitchen::Hold one{.hand = side_of(message.hold().is_left()),
                        .object = message.hold().object()};
      ENGRAM_RETURN_IF_ERROR(read_vector(message.hold().grasp(), "the grasp", one.grasp_object));
      return kitchen::BodyCommand(one);
    }
    case Kind::kRelease:
      return kitchen::BodyCommand(kitchen::Release{.hand = side_of(message.release().is_left())});
    case Kind::kStopAll:
      return kitchen::BodyCommand(kitchen::StopAll{});
    case Kind::COMMAND_NOT_SET:
      break;
  }
  return invalid_argument("bus: found a command of a kind that this body does not know");
}

}  // namespace engram::server
