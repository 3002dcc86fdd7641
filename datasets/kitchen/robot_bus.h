// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "datasets/kitchen/drawing_size.h"
#include "datasets/kitchen/robot_body.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"

namespace engram::datasets::kitchen {

/// What a robot's drivers are told of the body once. Unit: pixels, m, rad.
struct BodyDescription {
  uint64_t seed = 1;
  Time start{};        ///< The time of sample 0.
  double seconds = 0;  ///< How long it lives; 0: until it is ended.
  bool is_stepped = false;
  bool is_held = false;  ///< Time passes only while somebody lets it (BodySteps).
  /// The sample at which this client goes on: 0 at first, and after a driver died what that one was
  /// not done with.
  uint64_t begin = 0;
  int width = 0;  ///< Size of each image.
  int height = 0;
  int samples = 0;  ///< Samples per pixel.
  double lamp = 0;
  double daylight = 0;
  double warmth = 0;
  std::vector<double> lower;  ///< Ranges of the 43 joints.
  std::vector<double> upper;
  std::string urdf;
  Pose pose_head_left = Pose::Identity();  ///< Takes coordinates of a camera to the head's.
  Pose pose_head_right = Pose::Identity();

  [[nodiscard]] Time time_of(uint64_t sample) const;
  /// What is told of its images; drivers are not told of shadows.
  [[nodiscard]] DrawingSize size() const {
    return {.width = width, .height = height, .samples = samples};
  }
};

/// One object in the room, or the chair or the person.
struct SensedObject {
  std::string name;  ///< The name of a ThingClass.
  Pose pose = Pose::Identity();
  bool is_visible = false;
  std::string held_by;  ///< "left", "right", or empty.
};

/// What the body senses of itself and the room at one sample.
struct BodyState {
  uint64_t sample = 0;
  RobotVector positions = RobotVector::Zero();
  RobotVector velocities = RobotVector::Zero();
  Pose pose_world_left_hand = Pose::Identity();
  Pose pose_world_right_hand = Pose::Identity();
  std::vector<SensedObject> objects;
  /// An object was moved by hand since the last sample, so its pose is worth reporting.
  bool has_news = false;
  /// The last image that its driver committed, plus 1; 0: none.
  uint64_t images_until = 0;
  /// The platform stopped because this movable is in its way; empty: nothing is.
  std::string blocked_by;
};

/// Both images of the head at one sample. Shape: uint8 [height, width, 3], RGB.
struct BodyPicture {
  uint64_t sample = 0;
  idf::NdArray left;
  idf::NdArray right;
  Pose pose_world_left = Pose::Identity();
  Pose pose_world_right = Pose::Identity();
};

/// Commands to the body. A later one replaces what an earlier one of the same parts wants.
struct MoveJoints {
  std::vector<int> joints;  ///< Indices of RobotVector, without the platform.
  std::vector<double> to;   ///< As many; clamped to the joints' ranges.
  double seconds = 1;
};
/// Replies with the distance from the target at which the hand will end.
struct MoveHand {
  Side hand = Side::kRight;
  Pose pose_world_hand = Pose::Identity();
  double seconds = 1;
};
/// The neck follows an object, or a point if `object` is empty.
struct LookAt {
  std::string object;
  Eigen::Vector3d point{0, 0, 0};
};
/// A path segment of the platform: x, y, heading.
struct DriveTo {
  Eigen::Vector3d pose{0, 0, 0};
  double seconds = 1;
};
/// A velocity of the platform. Frame: the platform's: forward, left, turn. It holds for 0.3 s, so
/// that the platform stops by itself when its driver dies.
struct Drive {
  Eigen::Vector3d velocity{0, 0, 0};
};
/// Fixes an object to a hand that closed around it. Replies with the hand's distance from its
/// grasp; if that is above kHoldsWithin_m, nothing is held.
struct Hold {
  Side hand = Side::kRight;
  std::string object;
  Eigen::Vector3d grasp_object{0, 0, 0};  ///< Where the hand is to be. Frame: the object's.
};
struct Release {
  Side hand = Side::kRight;
};
/// Brings all joints and the platform to rest within 0.4 s.
struct StopAll {};

using BodyCommand =
    std::variant<MoveJoints, MoveHand, LookAt, DriveTo, Drive, Hold, Release, StopAll>;

/// The hardware interface of the robot: what its drivers and skills see of the body, as one client.
///
/// Time: a sample is 10 ms. A client says with wait() and draw() that it is done with all that
/// comes before. In stepped mode time stands still until all clients wait; else the clock runs.
/// Errors of all calls: kUnavailable if the body cannot be reached; kCancelled if it has ended.
/// Threading: one thread for each instance.
class RobotBus {
 public:
  virtual ~RobotBus() = default;

  virtual Result<BodyDescription> describe() = 0;

  /// Waits for a sample. A driver, whose name the body knows, is told the states from it on in
  /// their order, at most kMaxStates at once; any other client the newest one alone. States that
  /// are older than ten seconds are gone, so the first may be a later one. Errors: also kCancelled
  /// if `stop` is requested.
  virtual Result<std::vector<BodyState>> wait(uint64_t until, const std::stop_token& stop) = 0;

  /// Returns the newest state at once. The client is not done with its sample.
  virtual Result<BodyState> now() = 0;

  /// Waits for a sample, and draws what the cameras see at the newest one. `committed` is the
  /// BodyState::images_until that this client reached.
  /// Errors: also kInvalidArgument if `committed` is of an image that is still to come.
  virtual Result<BodyPicture> draw(uint64_t until, uint64_t committed,
                                   const std::stop_token& stop) = 0;

  /// Carries out a command from now on. Replies with a length as the command says, else 0.
  /// Errors: kInvalidArgument naming what is wrong with it; kNotFound naming the object;
  /// kFailedPrecondition if the body cannot do it now.
  virtual Result<double> command(const BodyCommand& command) = 0;

  /// Moves something by hand: 'chair to 1.0,2.0', 'person away', 'salt to table'. Returns what
  /// happened, in words.
  /// Errors: kInvalidArgument, kNotFound or kFailedPrecondition naming what is there.
  virtual Result<std::string> poke(const std::string& what) = 0;

  /// The name of the clients that carry out skills, of which there may be several at once.
  static constexpr std::string_view kSkills = "skills";

  static constexpr size_t kMaxStates = 500;
  static constexpr int kRate_hz = 100;
  static constexpr uint64_t kImageEvery = 5;
  static constexpr uint64_t kObjectsEvery = 20;
};

inline Time BodyDescription::time_of(uint64_t sample) const {
  return start +
         std::chrono::milliseconds(1000 / RobotBus::kRate_hz) * static_cast<int64_t>(sample);
}

}  // namespace engram::datasets::kitchen
