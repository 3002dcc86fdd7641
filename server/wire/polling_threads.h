// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

namespace engram::server {

/// The threads of this process in which gRPC works on connections and calls back.
///
/// It has two at least, and whichever sees an event first wakes another before it handles it: where
/// single messages come that costs more than they do. So all but one are held, as long as that one
/// keeps up; where it does not, because much comes or a handler blocks it, all work again.
///
/// Threading: thread-safe.
class PollingThreads {
 public:
  /// Made when it is first asked for, and from then on at work, until the process ends.
  static PollingThreads& of_process();

  PollingThreads(const PollingThreads&) = delete;
  PollingThreads& operator=(const PollingThreads&) = delete;

  /// How many are held at this moment.
  [[nodiscard]] int held() const;

  /// How many wait in handlers, and said so.
  [[nodiscard]] int blocked() const;

  /// Calls back in one of them.
  static void call(std::function<void()> back);

 private:
  friend class BlockingScope;

  PollingThreads();
  ~PollingThreads() = default;

  struct State;
  std::shared_ptr<State> state_;
};

/// Around a wait for what polling threads do. Where the waiting thread is one of them, in a
/// handler, others take over.
///
/// Threading: one thread.
class BlockingScope {
 public:
  BlockingScope();
  ~BlockingScope();
  BlockingScope(const BlockingScope&) = delete;
  BlockingScope& operator=(const BlockingScope&) = delete;

 private:
  const bool is_polling_thread_;
};

}  // namespace engram::server
