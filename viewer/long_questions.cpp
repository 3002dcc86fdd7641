// SPDX-License-Identifier: Apache-2.0
#include "viewer/long_questions.h"

#include <atomic>
#include <thread>

namespace engram::viewer {

struct LongQuestions::Running::State {
  std::stop_source stop;
  std::atomic<bool> is_called_off = false;
  // The clock waits here; it guards nothing.
  Mutex mutex;
  StoppableCondition passed;
  std::jthread clock;
};

LongQuestions::Running::Running(LongQuestions& owner, std::string name, Duration budget)
    : owner_(owner), name_(std::move(name)), budget_(budget), state_(std::make_shared<State>()) {
  // The thread ends before the state does, which joins it.
  state_->clock = std::jthread([state = state_.get(), budget](const std::stop_token& ended) {
    {
      const MutexLock lock(state->mutex);
      state->passed.wait_for(state->mutex, ended, budget, [] { return false; });
    }
    state->stop.request_stop();
  });
}

LongQuestions::Running::~Running() {
  const MutexLock lock(owner_.mutex_);
  auto& running = owner_.running_;
  const auto [first, last] = running.equal_range(name_);
  for (auto one = first; one != last; ++one)
    if (one->second == state_) {
      running.erase(one);
      break;
    }
}

std::stop_token LongQuestions::Running::stop() const {
  return state_->stop.get_token();
}

Status LongQuestions::Running::explained(const Status& ended, const std::string& what) const {
  if (ended.code() != StatusCode::kCancelled) return ended;
  if (state_->is_called_off)
    return unavailable("{} was called off, or asked for anew in the same page", what);
  return resource_exhausted("{} takes longer than {}; ask for less, or use the command line", what,
                            engram::to_string(budget_));
}

Result<std::unique_ptr<LongQuestions::Running>> LongQuestions::begin(const std::string& name,
                                                                     Duration budget) {
  call_off(name);
  std::unique_ptr<Running> running(new Running(*this, name, budget));
  bool is_full = false;
  {
    const MutexLock lock(mutex_);
    size_t others = 0;
    for (const auto& [key, state] : running_) others += state->is_called_off ? 0 : 1;
    is_full = others >= kMaxRunning;
    if (!is_full) running_.emplace(name, running->state_);
  }
  if (is_full)
    return unavailable("found {} long questions that are being worked on, needs fewer: ask again",
                       kMaxRunning);
  return running;
}

void LongQuestions::call_off(const std::string& name) {
  const MutexLock lock(mutex_);
  const auto [first, last] = running_.equal_range(name);
  for (auto one = first; one != last; ++one) {
    one->second->is_called_off = true;
    one->second->stop.request_stop();
  }
}

void LongQuestions::call_off_all() {
  const MutexLock lock(mutex_);
  for (const auto& [name, state] : running_) {
    state->is_called_off = true;
    state->stop.request_stop();
  }
}

}  // namespace engram::viewer
