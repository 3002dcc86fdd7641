// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "memory/memory.h"
#include "server/navigation/cost_map_provider.h"
#include "server/navigation/drive_base.h"
#include "server/navigation/driver.h"
#include "server/navigation/path_follower.h"

namespace engram::navigation::testing {

/// A room of 10 x 10 m with furniture, chairs that are pushed and persons who walk about, and a
/// platform in it, all on a simulated clock.
///
/// Persons go at up to 1 m/s to places that they choose; they do not walk into the robot, furniture
/// or each other, but come as near to the robot as 10 cm and stand in its way. Chairs are pushed
/// for a second at 0.4 m/s now and then, and not against anything. Each step is committed to the
/// memory as perception would do it, and the step ends when the map of it is there.
///
/// Simulated time stands still while the memory, the provider of maps and the driver work. In place
/// of what they take, everything is seen Options::latency late, and the platform hears each command
/// as late. Collisions are looked for every 10 ms, between the exact outlines where things and the
/// robot really are then.
///
/// Threading: one thread, that of the drive.
class SimulatedFloor : public DriveBase {
 public:
  struct Options {
    uint32_t seed = 1;
    int chairs = 5;
    int persons = 3;
    Duration latency{};  ///< Until a thing is seen where it is, and until a command is heard.
    double robot_radius_m = 0.3;
    double acceleration_m_s2 = 1.2;
    double turn_acceleration_rad_s2 = 5;
  };

  SimulatedFloor(Memory& memory, const Options& options);

  /// What is there, and the first states. Call it before a provider starts.
  Status commit_first();

  /// Whose maps the steps wait for.
  void wait_for_maps(const CostMapProvider& provider, const MapFeed& maps) {
    provider_ = &provider;
    maps_ = &maps;
  }

  void wait_for_no_maps() { provider_ = nullptr; }

  Result<BaseState> state() override;
  Status move(const Twist& twist) override;
  Status stop() override;
  Status wait(Duration time) override;

  /// Persons come to the robot and stand around it from now on, or go about again.
  void surround(bool is_on);

  /// Puts a thing somewhere, at once.
  Status put(const std::string& name, const PlanarPose& pose);
  void put_robot(const PlanarPose& pose) { robot_ = pose; }

  [[nodiscard]] int collisions() const { return collisions_; }
  [[nodiscard]] const std::string& collided_with() const { return collided_with_; }
  /// The smallest distance so far of the robot from anything. Unit: m.
  [[nodiscard]] double min_distance_m() const { return min_distance_m_; }
  [[nodiscard]] Time now() const { return now_; }

  /// Where a thing or piece of furniture really is. Nothing where there is no such one.
  [[nodiscard]] std::optional<Obstacle> body(const std::string& name) const;

  /// A place where the robot may stand.
  [[nodiscard]] PlanarPose free_place(double clear_m = 0.5);

  /// Called at the end of each step.
  std::function<void()> on_step;

 private:
  struct Mover {
    Obstacle body;  ///< Where it really is.
    double height_m = 0;
    Eigen::Vector2d goal = Eigen::Vector2d::Zero();
    double speed_m_s = 0;
    double pause_s = 0;
    std::deque<std::pair<Time, PlanarPose>> unseen{};
  };
  /// Puts it there; it is seen there later.
  void move_to(Mover& mover, const PlanarPose& pose) const;

  [[nodiscard]] double clearance_m(const Eigen::Vector2d& point, const std::string& but) const;
  void step(double seconds);
  void step_robot(double seconds);
  void step_person(Mover& person, int number, double seconds);
  void step_chair(Mover& chair, double seconds);
  bool try_to_go(Mover& mover, const Eigen::Vector2d& way, double seconds, double keeps_m);
  Status commit_seen();
  [[nodiscard]] Eigen::Vector2d random_point();

  Memory& memory_;
  const Options options_;
  std::mt19937 random_;
  Time now_;
  PlanarPose robot_{-3, -3, 0};
  Twist twist_;
  std::deque<std::pair<Time, Twist>> unheard_;
  Twist commanded_;
  std::vector<Obstacle> furniture_;
  std::vector<Mover> chairs_;
  std::vector<Mover> persons_;
  bool surrounds_ = false;
  int collisions_ = 0;
  bool touches_ = false;
  std::string collided_with_;
  double min_distance_m_ = 1e9;
  const CostMapProvider* provider_ = nullptr;
  const MapFeed* maps_ = nullptr;
};

}  // namespace engram::navigation::testing
