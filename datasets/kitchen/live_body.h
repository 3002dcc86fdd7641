// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/kitchen/body_steps.h"
#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/robot_bus.h"
#include "ltm/core/time.h"

namespace engram::datasets::kitchen {

/// The robot's body and its kitchen on a clock, for drivers and skills.
///
/// The clock is that of the machine, at some speed, or it is stepped: then time stands still until
/// all clients wait for a later sample. With equal options and equal commands a stepped body is in
/// equal states at equal times, however quick its clients are.
/// Threading: thread-safe.
/// Source: docs/kitchen.md, section "Live".
class LiveBody {
 public:
  struct Options {
    KitchenOptions kitchen;  ///< `seconds` is not used.
    double speed = 1;        ///< 0.01 to 100: how much faster than the clock time passes.
    bool is_stepped = false;
    std::vector<std::string> clients;  ///< Drivers; a stepped body waits for each.
    bool awaits_skills = false;  ///< A stepped body waits for a driver of skills too (BodySteps).
    bool is_held = false;        ///< Time stands still but while BodySteps::pass() runs.
    /// Tells the time of sample 0 once the room is built, which takes seconds; none: that of
    /// `kitchen`.
    Clock start{};
    double seconds = 0;              ///< When it ends; 0: when it goes.
    std::vector<std::string> pokes;  ///< What is moved before anything else happens.

    [[nodiscard]] Status validate() const;
  };

  struct Counters {
    uint64_t samples = 0;
    uint64_t pictures = 0;
    double behind_s = 0;  ///< How far the body is behind its clock now.
  };

  /// Starts the body. Errors: kInvalidArgument; those of RobotBus::poke; kUnavailable if nothing
  /// can be drawn.
  static Result<std::unique_ptr<LiveBody>> start(const Options& options);
  ~LiveBody();
  LiveBody(const LiveBody&) = delete;
  LiveBody& operator=(const LiveBody&) = delete;

  /// How long a client waits at once. Empty answers mean that the sample has not come yet; the
  /// client still waits for it, and asks again.
  struct Patience {
    std::stop_token stop{};
    Duration max = std::chrono::milliseconds(200);
  };

  /// A client, and which of those of its name.
  struct Client {
    std::string name;
    uint64_t bus = 0;
  };

  /// See RobotBus.
  [[nodiscard]] BodyDescription describe(const std::string& client = {}) const;
  Result<std::vector<BodyState>> wait(const Client& client, uint64_t until,
                                      const Patience& patience);
  [[nodiscard]] BodyState now() const;
  Result<std::optional<BodyPicture>> draw(const Client& client, uint64_t until, uint64_t committed,
                                          const Patience& patience);
  /// The client is there no longer.
  void leave(const Client& client);
  Result<double> command(const BodyCommand& command);
  Result<std::string> poke(const std::string& what);

  /// See BodySteps. An empty answer means that time still passes; the client asks again.
  Status step(SkillStep step);
  Result<std::optional<uint64_t>> pass(const PassWish& wish, const Patience& patience);

  [[nodiscard]] Counters counters() const;

  /// Ends it now: all that wait for it are told so.
  void end();
  [[nodiscard]] bool has_ended() const;
  /// Waits until the body has ended. Returns false if the stop came first.
  bool wait_for_end(const std::stop_token& stop);

  /// Return a bus for a client in this process, and the steps. The body must outlive them.
  [[nodiscard]] std::unique_ptr<RobotBus> bus(std::string client);
  [[nodiscard]] std::unique_ptr<BodySteps> steps();

 private:
  struct State;
  explicit LiveBody(std::unique_ptr<State> state);

  uint64_t next_bus();

  std::unique_ptr<State> state_;
};

}  // namespace engram::datasets::kitchen
