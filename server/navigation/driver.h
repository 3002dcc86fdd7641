// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "server/navigation/drive_log.h"
#include "server/navigation/map_feed.h"
#include "server/navigation/map_rules.h"
#include "server/navigation/path_follower.h"

namespace engram::navigation {

/// How a drive ended.
struct DriveOutcome {
  ::navigation::EventKind kind = ::navigation::EventKind::FAILED;
  std::string reason;  ///< In words, whatever happened.
  ltm::MemoryId event;
  ltm::MemoryId plan;  ///< The last one.
  double travelled_m = 0;
  Duration took{};
  int replans = 0;

  [[nodiscard]] bool has_arrived() const { return kind == ::navigation::EventKind::ARRIVED; }
};

/// Drives a robot to places, around what is in the way.
///
/// A drive plans on the newest cost map, checks that map against the objects themselves, follows
/// the way, plans again when a newer map blocks it or its goal was moved, waits where no way leads
/// on, and gives up with a reason. All of it is committed as events with links
/// (docs/navigation.md). It is what a skill calls; it knows no skills and no network.
///
/// Threading: thread-safe; it does one thing at a time, and refuses another meanwhile.
/// Owns: nothing of the memory, which must outlive it.
class Driver {
 public:
  struct Options {
    std::string robot = "robot";
    MapRules rules;  ///< Those of the provider of the maps.
    PathPlanner::Options planner;
    DriveLimits limits;
    Duration period = std::chrono::milliseconds(50);  ///< Between two commands to the platform.
    /// How long it waits where no way leads on, or something is too near, before it gives up.
    Duration patience = std::chrono::seconds(10);
    /// How long it waits for a map that has what the objects say.
    Duration map_patience = std::chrono::seconds(2);
    Duration time_limit = std::chrono::minutes(5);  ///< For a whole drive.

    [[nodiscard]] Status validate() const;
  };

  /// Called with each event, in words; a skill reports it to whoever called it.
  using Report = std::function<void(::navigation::EventKind kind, const std::string& text)>;

  /// Errors: kInvalidArgument for options that do not validate; those of MapFeed and DriveLog.
  static Result<std::unique_ptr<Driver>> open(Memory& memory, const Options& options);

  /// Drives, and returns when the robot rests: it arrived, or the outcome says why not. A request
  /// that names no place, a place that nobody knows, a goal that is not free and a robot that is
  /// trapped are outcomes, not errors. While the memory does not answer the robot rests; `stop` and
  /// the time limit count again once it has.
  /// Errors: kFailedPrecondition where it drives or plans already, which goes on; those of the base
  /// and of the memory. The base was told to stop then.
  Result<DriveOutcome> drive(const DriveRequest& request, DriveBase& base,
                             const std::stop_token& stop = {}, const Report& report = {});

  /// Plans without driving, and commits the plan. `from` is where the robot would start.
  /// Returns the link to the plan, whose state may be refused.
  /// Errors: kFailedPrecondition where it drives or plans already; those of the memory.
  Result<ltm::MemoryId> plan(const DriveRequest& request, const PlanarPose& from, Time time);

  /// The maps that it drives by.
  [[nodiscard]] MapFeed& maps() { return *maps_; }

 private:
  friend class DriveRun;

  Driver(Memory& memory, const Options& options, PathPlanner planner, DriveLog log,
         std::unique_ptr<MapFeed> maps);

  Memory& memory_;
  const Options options_;
  const PathPlanner planner_;
  DriveLog log_;
  std::unique_ptr<MapFeed> maps_;
  std::atomic<bool> is_busy_ = false;
};

}  // namespace engram::navigation
