// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the requests to the robot, and the faults.

#include <optional>
#include <string>

#include "datasets/kitchen/kitchen_layout.h"
#include "datasets/kitchen/kitchen_random.h"
#include "datasets/kitchen/robot_body.h"

namespace engram::datasets::kitchen {

/// The reason why a grasp fails.
enum class GraspFault {
  kShort,  ///< The hand stops short of the thing and closes around nothing.
  kSlip,   ///< The hand opens a little while it lifts.
};

/// A request to carry one thing from its place to the other surface.
struct Task {
  size_t thing = 0;
  Surface from = Surface::kCounter;
  Surface to = Surface::kTable;
  int slot = 0;  ///< A slot of `to`.
  Side hand = Side::kRight;
  std::string words;                ///< What the person says.
  std::optional<GraspFault> fault;  ///< The fault of the first grasp.
  bool is_stopped = false;          ///< A person says stop during the first reach.
};

/// Makes one task after another. Equal layouts and outcomes give equal tasks.
///
/// Threading: one thread.
class Script {
 public:
  explicit Script(const Layout& layout);

  /// Returns nothing if no thing is left that can be carried.
  [[nodiscard]] std::optional<Task> next();

  /// Reports that the thing is at the target of the task.
  void done(const Task& task);
  /// Reports that the thing fell over and cannot be grasped any more.
  void lose(size_t thing);

 private:
  struct Standing {
    Surface surface;
    int slot;
    bool is_lost = false;
  };

  [[nodiscard]] std::vector<int> free_slots(Surface surface) const;

  const Layout& layout_;
  Random random_;
  std::vector<Standing> standing_;
  std::optional<size_t> last_;
  size_t count_ = 0;
  size_t fault_at_ = 0;  ///< The number of the task whose grasp fails.
  size_t stop_at_ = 0;
};

}  // namespace engram::datasets::kitchen
