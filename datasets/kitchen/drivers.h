// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <stop_token>
#include <string>

#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/robot_bus.h"

namespace engram::datasets::kitchen {

/// Where a driver puts what it reads from the body.
struct DriverOptions {
  CommitSink commit;
  /// Declares the types, before the first commit and after the memory was away.
  std::function<Status()> declare;
  /// Told a sentence when something changes.
  std::function<void(const std::string& words)> say;
  /// Told the driver's figures, about every `figures_every` of the wall's clock.
  std::function<void(const std::map<std::string, double>& figures)> tell;
  Duration figures_every = std::chrono::seconds(10);
};

/// Reads joints and platform at 100 Hz and objects at 5 Hz from the body and commits them, after
/// what is known before: the robot's description, surfaces and kinds of objects.
///
/// While the memory is away, what is sensed is lost and counted, because a robot's senses do not
/// wait. A stepped body does wait. What the body no longer remembers when it asks is lost too, and
/// said. Figures: samples, lost (samples), away (times that the memory was), interval_p50_ms and
/// interval_p99_ms between commits of this time.
/// Errors: those of the bus but kCancelled, which ends it; those of the memory but kUnavailable.
Status drive_state(RobotBus& bus, const DriverOptions& options, const std::stop_token& stop);

/// Reads the images of both cameras and commits them, 20 in a second if the machine draws as many.
/// Figures: images, skipped (images of the 20 a second that were not drawn in time, and those before
/// it had begun), lost, away, images_per_s.
/// Errors: those of drive_state.
Status drive_camera(RobotBus& bus, const DriverOptions& options, const std::stop_token& stop);

}  // namespace engram::datasets::kitchen
