// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: one drive, from its first plan to its last event.

#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "server/navigation/choose_path.h"
#include "server/navigation/driver.h"
#include "server/navigation/path_follower.h"
#include "server/navigation/work_aside.h"

namespace engram::navigation {

/// One drive.
///
/// The memory is asked aside: while an answer is late the robot stops, because who waits for a slow
/// server does not see who walks into the way. Plans and events are committed while the robot rests
/// or brakes.
/// Threading: one thread.
class DriveRun {
 public:
  DriveRun(Driver& driver, const DriveRequest& request, DriveBase& base,
           const std::stop_token& stop, const Driver::Report& report);

  Result<DriveOutcome> go();

 private:
  /// What `question` returns, a Status or a Result. Where that takes long, the base is told to stop
  /// meanwhile, and `was_late_` is set: where the robot and the things are has to be looked at
  /// anew.
  template <typename Question>
  auto asked(const Question& question) -> decltype(question()) {
    using Answer = decltype(question());
    std::optional<Answer> answer;
    Status stopped;
    aside_.run([&] { answer = question(); }, kSoon,
               [&] {
                 was_late_ = true;
                 stopped = base_.stop();
               });
    if (!stopped.ok()) return Answer(stopped);
    return *std::move(answer);
  }

  /// Reads the newest map and the base.
  Status look();
  /// Plans until a map is there that agrees with the objects. Returns whether there is a way.
  Result<bool> plan_first();
  /// One command to the base. Returns whether the drive goes on.
  Result<bool> go_on();
  Result<bool> replan();
  /// Whether what was asked for by name is still where the robot drives to. It is looked for twice
  /// a second, and at once if that is urgent; also if no map came, because a thing in a hand or on
  /// furniture and a location move without one.
  Result<bool> is_goal_there(bool is_urgent);
  /// Remembers the goal of a way that was found.
  void keep_goal(const ChosenPath& chosen);
  /// Notes whether the robot came on or turned since it last did.
  void note_motion();
  /// Whether the map is still that of the objects, or will be soon.
  Result<bool> is_map_kept();
  /// What to do while nothing moves: wait, and give up at last.
  Result<bool> wait_or_give_up(const FoundPath& blocked);

  Status commit_plan(const ChosenPath& chosen);
  Status commit_event(::navigation::EventKind kind, const std::string& reason,
                      const std::vector<Obstacle>& blocked_by = {});
  /// Stops, waits until the robot rests, and commits the last event.
  Result<bool> end(::navigation::EventKind kind, const std::string& reason,
                   const std::vector<Obstacle>& blocked_by = {});

  [[nodiscard]] PathInputs path_inputs() const;

  /// Memories answer within this time, or else the robot stops until they do.
  static constexpr Duration kSoon = std::chrono::milliseconds(20);

  Driver& driver_;
  const DriveRequest request_;
  DriveBase& base_;
  const std::stop_token stop_;
  const Driver::Report report_;

  BaseState state_;
  std::shared_ptr<const CostMap> map_;
  std::unique_ptr<PathFollower> follower_;
  std::optional<KeptGoal> goal_;
  DriveOutcome outcome_;
  Time started_{};
  Time planned_{};                    ///< When it last planned.
  Time moved_{};                      ///< When it last came on.
  std::optional<Time> blocked_{};     ///< Since when no way leads on.
  std::optional<PlanarPose> here_{};  ///< Where it last came on to.
  std::optional<Obstacle> held_by_{};
  ltm::MemoryId looked_at_;  ///< The map that the way was compared with.
  Time goal_checked_{};      ///< When the goal was last found.
  Time checked_{};           ///< When the map was last compared with the objects.
  ltm::MemoryId stale_map_;  ///< The map that was stale then.
  std::string stale_;        ///< What was newer.
  bool was_late_ = false;    ///< An answer of the memory came late since the last look.
  WorkAside aside_;
};

}  // namespace engram::navigation
