// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>

namespace engram::server {

/// Controls the threads of this process in which gRPC works on connections and runs callbacks.
///
/// gRPC has at least two such threads, and the one that sees an event first wakes another before it
/// handles the event. On two cores that took a third of a single message's time. All threads but
/// one are therefore held back while that one keeps up. If it falls behind, because there is much
/// traffic or a handler blocks it, all threads work again.
///
/// Threading: thread-safe.
class PollingThreads {
 public:
  /// Returns the instance of the process. It is made on first use and works until the process ends.
  static PollingThreads& of_process();

  PollingThreads(const PollingThreads&) = delete;
  PollingThreads& operator=(const PollingThreads&) = delete;

  /// The number of threads that are held back now.
  [[nodiscard]] int held() const;

  /// The number of threads that wait inside handlers within a BlockingScope.
  [[nodiscard]] int blocked() const;

  /// Calls `back` in a polling thread.
  static void call(std::function<void()> back);

 private:
  friend class BlockingScope;

  PollingThreads();
  ~PollingThreads() = default;

  struct State;
  std::shared_ptr<State> state_;
};

/// Marks a wait for something that polling threads do. If the waiting thread is itself a polling
/// thread, in a handler, others take over.
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
