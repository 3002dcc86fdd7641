// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <stop_token>
#include <string>

#include "ltm/core/mutex.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::viewer {

/// Questions that may take long: each ends at its time, and when whoever asked calls it off.
///
/// A page names its questions; a new one of a name takes the place of the one before. Few are
/// worked on at a time, so that threads are left for short ones. Threading: thread-safe.
class LongQuestions {
 public:
  static constexpr size_t kMaxRunning = 2;

  /// A question that is being worked on, until this ends.
  class Running {
   public:
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    [[nodiscard]] std::stop_token stop() const;

    /// Says why work that ended with kCancelled did: its time was over (kResourceExhausted), or it
    /// was called off (kUnavailable). Other errors stay as they are. `what` is what took too long.
    [[nodiscard]] Status explained(const Status& ended, const std::string& what) const;

   private:
    friend class LongQuestions;
    struct State;
    Running(LongQuestions& owner, std::string name, Duration budget);

    LongQuestions& owner_;
    std::string name_;
    Duration budget_;
    std::shared_ptr<State> state_;
  };

  /// Begins a question, after calling off the one of the same name.
  /// Errors: kUnavailable if enough others are being worked on.
  Result<std::unique_ptr<Running>> begin(const std::string& name, Duration budget);

  /// Calls off the question of a name; nothing where there is none.
  void call_off(const std::string& name);

  /// Calls off all of them, because the viewer ends.
  void call_off_all();

 private:
  Mutex mutex_;
  std::multimap<std::string, std::shared_ptr<Running::State>> running_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::viewer
