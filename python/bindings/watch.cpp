// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/watch.h"

#include <unistd.h>

#include "python/bindings/errors.h"
#include "python/bindings/query_result.h"

namespace engram::python {

namespace {

namespace py = pybind11;

/// The max delay of a signal. Waking up is cheap, because it only takes the interpreter's lock.
constexpr auto kBetweenSignals = std::chrono::milliseconds(50);

/// The size of an event beside its values. Unit: bytes.
constexpr size_t kEventBytes = 256;

memory::EventQueue<ToldSnapshot>::Bounds bounds_of(size_t bound) {
  memory::EventQueue<ToldSnapshot>::Bounds bounds;
  if (bound > 0) bounds.events = bound;
  return bounds;
}

py::dict event_of(Inbox::Told told) {
  ltm::Snapshot& snapshot = told.snapshot.snapshot;
  ltm::SnapshotResult shown;
  shown.time = snapshot.time;
  for (ltm::Instance& instance : snapshot.instances)
    shown.append(std::move(instance.data), instance.metadata);
  py::dict event;
  event["snapshot"] = snapshots_of(snapshot.entity, {std::move(shown)})[0];
  event["has_data"] = told.snapshot.has_data;
  event["lost"] = told.lost;
  event["interruption"] = told.interruption;
  return event;
}

}  // namespace

Inbox::Inbox(size_t bound) : waiting_(bounds_of(bound)) {}

SubscriptionHandlers Inbox::handlers(const std::shared_ptr<Inbox>& inbox) {
  SubscriptionHandlers handlers;
  handlers.on_snapshots = [inbox](std::vector<ToldSnapshot> told) { inbox->put(std::move(told)); };
  handlers.on_lost = [inbox](uint64_t lost) {
    const MutexLock lock(inbox->mutex_);
    inbox->lost_before_ += lost;
  };
  handlers.on_interrupted = [inbox](const Status& status) {
    const MutexLock lock(inbox->mutex_);
    ++inbox->interruptions_;
    inbox->interruption_ = status.ok() ? "the server ended the stream" : status.message();
  };
  return handlers;
}

void Inbox::put(std::vector<ToldSnapshot> told) {
  const MutexLock lock(mutex_);
  if (is_closed_) return;
  for (ToldSnapshot& one : told) {
    const size_t bytes = kEventBytes + (one.has_data ? one.snapshot.raw_bytes() : 0);
    waiting_.push(std::move(one), bytes);
  }
  changed_.notify_one();
}

std::optional<Inbox::Told> Inbox::take(Duration max_wait) {
  const MutexLock lock(mutex_);
  changed_.wait_for(mutex_, max_wait,
                    [this]() ENGRAM_REQUIRES(mutex_) { return is_closed_ || !waiting_.empty(); });
  if (is_closed_ || waiting_.empty()) return std::nullopt;
  Told told{waiting_.pop()};
  const uint64_t lost = lost_before_ + waiting_.lost();
  told.lost = lost - std::exchange(told_lost_, lost);
  told.interruption = std::exchange(interruption_, {});
  return told;
}

void Inbox::close() {
  const MutexLock lock(mutex_);
  is_closed_ = true;
  while (!waiting_.empty()) waiting_.pop();
  changed_.notify_all();
}

bool Inbox::is_closed() const {
  const MutexLock lock(mutex_);
  return is_closed_;
}

uint64_t Inbox::lost() const {
  const MutexLock lock(mutex_);
  return lost_before_ + waiting_.lost();
}

uint64_t Inbox::interruptions() const {
  const MutexLock lock(mutex_);
  return interruptions_;
}

Watch::Watch(std::shared_ptr<Inbox> inbox, std::unique_ptr<Subscription> subscription)
    : process_(::getpid()), inbox_(std::move(inbox)), subscription_(std::move(subscription)) {}

Watch::~Watch() {
  if (process_ == ::getpid()) {
    close();
    return;
  }
  // A forked process lacks the threads that ending would wait for, so the subscription is leaked.
  [[maybe_unused]] const Subscription* const left = subscription_.release();
}

py::object Watch::next(std::optional<int64_t> timeout) {
  if (process_ != ::getpid())
    raise(failed_precondition("the watch was begun by another process: begin one in this one"));
  using Clock = std::chrono::steady_clock;
  const auto begun = Clock::now();
  while (true) {
    Duration left = kBetweenSignals;
    if (timeout) left = std::min(left, Duration(*timeout) - Duration(Clock::now() - begun));
    auto told = [&] {
      const py::gil_scoped_release released;
      return inbox_->take(left);
    }();
    if (told) return event_of(*std::move(told));
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (inbox_->is_closed() || (timeout && left <= Duration(0))) return py::none();
  }
}

void Watch::close() {
  const py::gil_scoped_release released;
  inbox_->close();
  const MutexLock lock(mutex_);
  subscription_.reset();
}

}  // namespace engram::python
