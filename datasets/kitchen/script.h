// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what the robot is asked for, and what goes wrong.

#include <optional>
#include <string>

#include "datasets/kitchen/kitchen_layout.h"
#include "datasets/kitchen/kitchen_random.h"
#include "datasets/kitchen/robot_body.h"

namespace engram::datasets::kitchen {

/// What makes a grasp fail.
enum class GraspFault {
  kShort,  ///< The hand stops short of the thing and closes around nothing.
  kSlip,   ///< It opens a little while it lifts.
};

/// One thing to be carried from where it stands to the other surface.
struct Task {
  size_t thing = 0;
  Surface from = Surface::kCounter;
  Surface to = Surface::kTable;
  int slot = 0;  ///< Of `to`.
  Side hand = Side::kRight;
  std::string words;                ///< Of who asks for it.
  std::optional<GraspFault> fault;  ///< Of the first grasp.
  bool is_stopped = false;          ///< Somebody says stop during the first reach.
};

/// Makes up one task after another; the same for the same layout and outcomes.
///
/// Threading: one thread.
class Script {
 public:
  explicit Script(const Layout& layout);

  /// Nothing where no thing is left that can be carried.
  [[nodiscard]] std::optional<Task> next();

  /// The thing stands where the task wanted it.
  void done(const Task& task);
  /// It cannot be grasped any more: it fell over.
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
  size_t fault_at_ = 0;  ///< Number of the task whose grasp fails.
  size_t stop_at_ = 0;
};

}  // namespace engram::datasets::kitchen
