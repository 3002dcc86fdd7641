// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>

#include "ltm/core/status.h"

namespace engram::datasets::kitchen {

/// What the driver of skills tells a stepped body.
enum class SkillStep : uint8_t {
  kCome,   ///< It has come. What one before it had begun is gone; time stands still.
  kReady,  ///< It carries out what it is asked for: time may pass.
  kBegin,  ///< An execution begins at the sample that is now.
  kEnd,    ///< One has ended, and its bus is gone.
};

/// A wish that time passes in a body whose time is held.
struct PassWish {
  uint64_t id = 0;         ///< Whoever asks again for the same has the same.
  uint64_t samples = 1;    ///< 0 withdraws the wish of that ID.
  bool until_end = false;  ///< It is over as soon as an execution of a skill ends.
};

/// How the driver of skills takes part in the steps of a body.
///
/// Time: each execution of a skill has a RobotBus of its own, a client of the name
/// RobotBus::kSkills. From kBegin on time stands still until that bus waits, and again whenever it
/// does not wait. A body that is held stands still besides, except while pass() runs.
/// Errors of all calls: kFailedPrecondition if the body does not wait for skills; kUnavailable if
/// it cannot be reached; kCancelled if it has ended. Threading: thread-safe. Source:
/// docs/kitchen.md, section "Steps".
class BodySteps {
 public:
  virtual ~BodySteps() = default;

  virtual Status tell(SkillStep step) = 0;

  /// Lets time pass. Returns the sample at which it stands again, once all clients are done with
  /// it. Errors: also kFailedPrecondition if time is not held; kCancelled if `stop` is requested,
  /// and then time stands again.
  virtual Result<uint64_t> pass(const PassWish& wish, const std::stop_token& stop) = 0;
};

}  // namespace engram::datasets::kitchen
