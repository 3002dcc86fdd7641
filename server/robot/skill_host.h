// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "ltm/core/mutex.h"
#include "memory/live/event_hub.h"
#include "memory/memory.h"
#include "server/skills/skill_memory.h"

namespace engram::server {

/// The skill memory of a server, which starts when it is first needed: a server without skills has
/// neither its thread nor its types in the store.
///
/// Threading: thread-safe.
class SkillHost {
 public:
  using OpenMemory = std::function<Result<std::unique_ptr<Memory>>()>;

  /// `open` gives the memory in which conditions are looked up, and what is written.
  SkillHost(OpenMemory open, skills::SkillMemory::Options options)
      : open_(std::move(open)), options_(std::move(options)) {}
  ~SkillHost();

  /// The running skill memory.
  /// Errors: those of `open` and SkillMemory::start; kUnavailable once it is closed.
  Result<skills::SkillMemory*> get() ENGRAM_EXCLUDES(mutex_);

  /// Null if nobody has needed it yet. It does not wait for one that is starting, which may ask
  /// this very server.
  [[nodiscard]] skills::SkillMemory* started() const { return started_; }

  /// Starts it once somebody asks for a skill, by a thread of its own. `hub` must outlive it.
  void start_on_request(memory::EventHub& hub);

  /// Ends what runs. The skill memory stays there for those who have it, but does nothing.
  void close() ENGRAM_EXCLUDES(mutex_);

 private:
  class FirstRequest;

  const OpenMemory open_;
  const skills::SkillMemory::Options options_;
  Mutex mutex_;
  bool is_closed_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::unique_ptr<Memory> memory_ ENGRAM_GUARDED_BY(mutex_);
  std::unique_ptr<skills::SkillMemory> skills_ ENGRAM_GUARDED_BY(mutex_);
  std::atomic<skills::SkillMemory*> started_{nullptr};
  memory::EventHub* hub_ = nullptr;
  std::shared_ptr<FirstRequest> first_;
  std::jthread starting_;  ///< Ends before the other members.
};

}  // namespace engram::server
