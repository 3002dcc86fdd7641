// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/work_queue.h"

namespace engram::server {

WorkQueue::WorkQueue(int threads) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

WorkQueue::~WorkQueue() {
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_all();
}

void WorkQueue::add(std::function<void()> work) {
  {
    const MutexLock lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  wake_.notify_one();
}

void WorkQueue::run() {
  for (MutexLock lock(mutex_);;) {
    wake_.wait(mutex_,
               [this]() ENGRAM_REQUIRES(mutex_) { return is_ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const auto work = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    work();
    lock.lock();
  }
}

}  // namespace engram::server
