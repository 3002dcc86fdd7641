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
  std::unique_lock lock(mutex_);
  work_ = &work;
  count_ = count;
  next_ = finished_ = 0;
  more_.notify_all();
  while (next_ < count_) take_one(lock);
  done_.wait(lock, [this] { return finished_ == count_; });
  count_ = next_ = 0;
}

void WorkerPool::serve(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (more_.wait(lock, stop, [this] { return next_ < count_; })) take_one(lock);
}

void WorkerPool::take_one(std::unique_lock<std::mutex>& lock) {
  const size_t index = next_++;
  const auto& work = *work_;
  lock.unlock();
  work(index);
  lock.lock();
  if (++finished_ == count_) done_.notify_one();
}

}  // namespace engram::ltm
