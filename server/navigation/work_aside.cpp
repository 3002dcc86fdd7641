// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/work_aside.h"

namespace engram::navigation {

WorkAside::WorkAside() : thread_([this](const std::stop_token& stop) { work_on(stop); }) {}

void WorkAside::run(const std::function<void()>& work, Duration soon,
                    const std::function<void()>& when_late) {
  MutexLock lock(mutex_);
  work_ = &work;
  has_work_.notify_one();
  const auto is_done = [this]() ENGRAM_REQUIRES(mutex_) { return work_ == nullptr; };
  if (is_done_.wait_for(mutex_, soon, is_done)) return;
  lock.unlock();
  when_late();
  lock.lock();
  is_done_.wait(mutex_, is_done);
}

void WorkAside::work_on(const std::stop_token& stop) {
  MutexLock lock(mutex_);
  while (
      has_work_.wait(mutex_, stop, [this]() ENGRAM_REQUIRES(mutex_) { return work_ != nullptr; })) {
    const std::function<void()>& work = *work_;
    lock.unlock();
    work();
    lock.lock();
    work_ = nullptr;
    is_done_.notify_one();
  }
}

}  // namespace engram::navigation
