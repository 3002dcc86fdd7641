// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/journal_syncer.h"

#include <algorithm>
#include <utility>

namespace engram::ltm {

JournalSyncer::JournalSyncer(Duration interval)
    : interval_(interval), thread_([this](const std::stop_token& stop) { run(stop); }) {}

JournalSyncer::~JournalSyncer() = default;

void JournalSyncer::run(const std::stop_token& stop) {
  MutexLock lock(mutex_);
  while (
      changed_.wait(mutex_, stop, [this]() ENGRAM_REQUIRES(mutex_) { return !dirty_.empty(); })) {
    const auto journals = std::exchange(dirty_, {});
    lock.unlock();
    Status status;
    for (const auto& [journal, bytes] : journals)
      if (Status each = journal->sync(bytes); !each.ok()) status = std::move(each);
    lock.lock();
    if (!status.ok()) error_ = std::move(status);
    changed_.wait_for(mutex_, stop, interval_, [] { return false; });
  }
}

void JournalSyncer::note_append(const std::shared_ptr<Journal>& journal, uint64_t bytes) {
  const MutexLock lock(mutex_);
  const auto known = std::ranges::find(dirty_, journal, &Dirty::journal);
  if (known != dirty_.end()) {
    known->bytes = bytes;
    return;
  }
  dirty_.push_back({journal, bytes});
  changed_.notify_all();
}

Status JournalSyncer::take_error() {
  const MutexLock lock(mutex_);
  return std::exchange(error_, Status());
}

}  // namespace engram::ltm
