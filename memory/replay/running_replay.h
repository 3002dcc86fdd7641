// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "ltm/recall/model.h"
#include "memory/live/past_below.h"
#include "memory/replay/replay_command.h"
#include "memory/replay/replay_options.h"
#include "memory/replay/replay_state.h"

namespace engram::memory {

/// The stores of a robot as they were at a moment, on one clock: the past below a memory service
/// for each of them (MemoryService::Options::below).
///
/// Whoever asks such a service is answered as the robot was at that moment, whoever subscribes is
/// told in the recorded order, and what is committed is there until the replay jumps to a moment
/// before it, or ends. Nothing is written to a store. What is recorded after the replay began is no
/// part of it.
///
/// Owns: a thread, which tells what the clock passes.
/// Threading: thread-safe.
/// Source: docs/replay.md.
class Replay : public std::enable_shared_from_this<Replay> {
 public:
  /// Errors: kInvalidArgument for options that do not validate, without a store, or if `at` lies
  /// before the first snapshot or none was recorded; those of ltm::StorePast::open.
  static Result<std::shared_ptr<Replay>> open(const std::vector<std::filesystem::path>& stores,
                                              ltm::ModelLoader loader,
                                              const ReplayOptions& options);
  ~Replay();
  Replay(const Replay&) = delete;
  Replay& operator=(const Replay&) = delete;

  /// The past below the service that serves a store, which keeps this alive. Make one for each.
  /// The one that `tells_of_replay` has the memory SystemState: its service is committed what the
  /// replay says of itself, and takes commands.
  [[nodiscard]] std::shared_ptr<PastBelow> below(size_t store, bool tells_of_replay = true);

  /// Does what it is told. Once this returns, all that is asked is of the new moment.
  /// Errors: those of ReplayCommand::validate; kInvalidArgument if it is to go before the first
  /// snapshot; kNotFound for a step behind the last one.
  Status obey(const ReplayCommand& command);

  [[nodiscard]] ReplayState state() const;

 private:
  struct State;
  class Below;
  explicit Replay(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::memory
