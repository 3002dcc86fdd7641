// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/worker_pool.h"

namespace engram::ltm {

WorkerPool::WorkerPool(int threads) {
  for (int i = 1; i < threads; ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { serve(stop); });
}

void WorkerPool::run(size_t count, const std::function<void(size_t)>& work) {
  if (threads_.empty() || count < 2) {
    for (size_t i = 0; i < count; ++i) work(i);
    return;
  }
  const MutexLock lock(mutex_);
  work_ = &work;
  count_ = count;
  next_ = finished_ = 0;
  more_.notify_all();
  while (next_ < count_) take_one();
  done_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) { return finished_ == count_; });
  count_ = next_ = 0;
}

void WorkerPool::serve(const std::stop_token& stop) {
  const MutexLock lock(mutex_);
  while (more_.wait(mutex_, stop, [this]() ENGRAM_REQUIRES(mutex_) { return next_ < count_; }))
    take_one();
}

void WorkerPool::take_one() {
  const size_t index = next_++;
  const auto& work = *work_;
  mutex_.unlock();
  work(index);
  mutex_.lock();
  if (++finished_ == count_) done_.notify_one();
}

}  // namespace engram::ltm
