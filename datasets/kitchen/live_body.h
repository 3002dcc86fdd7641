// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/robot_bus.h"

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
    std::vector<std::string> clients;  ///< Those that a stepped body waits for.
    double seconds = 0;                ///< When it ends; 0: when it goes.
    std::vector<std::string> pokes;    ///< What is moved before anything else happens.

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

  /// See RobotBus, for a client of this name.
  [[nodiscard]] const BodyDescription& describe() const;
  Result<std::vector<BodyState>> wait(const std::string& client, uint64_t until,
                                      const Patience& patience);
  Result<std::optional<BodyPicture>> draw(const std::string& client, uint64_t until,
                                          uint64_t committed, const Patience& patience);
  Result<double> command(const BodyCommand& command);
  Result<std::string> poke(const std::string& what);

  [[nodiscard]] Counters counters() const;

  [[nodiscard]] bool has_ended() const;
  /// Waits until the body has ended. Returns false if the stop came first.
  bool wait_for_end(const std::stop_token& stop);

  /// Returns a bus for a client in this process. The body must outlive it.
  [[nodiscard]] std::unique_ptr<RobotBus> bus(std::string client);

 private:
  struct State;
  explicit LiveBody(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::datasets::kitchen
