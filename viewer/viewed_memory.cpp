// SPDX-License-Identifier: Apache-2.0
#include "viewer/viewed_memory.h"

namespace engram::viewer {

namespace {

constexpr int kAttempts = 3;

/// Readers that wait for a request. Each keeps open files and decoded windows of them.
constexpr size_t kMaxIdleReaders = 4;

}  // namespace

Result<std::unique_ptr<ViewedMemory>> ViewedMemory::open(Options options) {
  std::unique_ptr<ViewedMemory> viewed(new ViewedMemory(std::move(options)));
  ENGRAM_ASSIGN_OR_RETURN(viewed->memory_, viewed->options_.open(false));
  // What is wrong with a store is told before a page is shown.
  if (viewed->is_store())
    ENGRAM_RETURN_IF_ERROR(viewed->with_store([](const StoreView&) { return Status(); }));
  return viewed;
}

Result<Memory*> ViewedMemory::latents() {
  if (!is_store())
    return failed_precondition(
        "'{}': a server answers from the form that it is configured for; open its store to see "
        "both",
        options_.name);
  const MutexLock lock(mutex_);
  return opened(latents_, true);
}

Status ViewedMemory::with_asker(const std::function<Status(speech::Asker&)>& use) {
  const MutexLock lock(asking_);
  if (asker_ == nullptr) {
    speech::Asker::Options asking;
    if (options_.open_reader) {
      ENGRAM_ASSIGN_OR_RETURN(asking.reader, options_.open_reader());
    }
    ENGRAM_ASSIGN_OR_RETURN(asker_, speech::Asker::create(*memory_, asking));
  } else {
    ENGRAM_RETURN_IF_ERROR(asker_->refresh());
  }
  return use(*asker_);
}

Result<Memory*> ViewedMemory::for_long_questions() {
  if (!is_store()) return memory_.get();  // A server has threads for them.
  const MutexLock lock(mutex_);
  return opened(for_long_questions_, false);
}

Result<Memory*> ViewedMemory::opened(std::unique_ptr<Memory>& memory, bool prefers_latents) {
  if (memory == nullptr) {
    ENGRAM_ASSIGN_OR_RETURN(memory, options_.open(prefers_latents));
  }
  return memory.get();
}

Result<ViewedMemory::Lent> ViewedMemory::open_reader() {
  // Taken before it is opened: a store that changes meanwhile has another mark then.
  ltm::StoreMark mark = ltm::look_at_store(options_.store);
  Lent lent;
  ENGRAM_ASSIGN_OR_RETURN(lent.reader, ltm::StoreReader::open(options_.store));
  lent.opened = steady_now();
  const MutexLock lock(mutex_);
  if (state_ == 0 || mark != mark_) {
    mark_ = std::move(mark);
    ++state_;
    times_.clear();
    times_bytes_ = 0;
    numbers_.clear();
    idle_.clear();
  }
  lent.state = state_;
  return lent;
}

Result<ViewedMemory::Lent> ViewedMemory::lend(bool is_new) {
  if (!is_new) {
    // Looking takes microseconds; it is done without the lock because a disk may be slow.
    const ltm::StoreMark mark = ltm::look_at_store(options_.store);
    const MutexLock lock(mutex_);
    while (!idle_.empty()) {
      Lent lent = std::move(idle_.back());
      idle_.pop_back();
      const bool is_present = lent.state == state_ && mark == mark_;
      if (is_present || steady_now() - lent.opened < options_.max_age) return lent;
    }
  }
  return open_reader();
}

Status ViewedMemory::with_store(const Read& read) {
  if (!is_store())
    return failed_precondition("'{}': a server does not tell this; open its store", options_.name);
  Status last;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    ENGRAM_ASSIGN_OR_RETURN(Lent lent, lend(attempt > 0));
    last = read({*lent.reader, lent.state});
    if (last.code() == StatusCode::kUnavailable) continue;
    // A reader that met damage is not lent again: the store may be repaired.
    const MutexLock lock(mutex_);
    if (last.code() != StatusCode::kDataLoss && idle_.size() < kMaxIdleReaders)
      idle_.push_back(std::move(lent));
    return last;
  }
  return last;
}

Result<ViewedMemory::SharedTimes> ViewedMemory::times(const StoreView& view,
                                                      const ltm::MemoryId& entity) {
  {
    const MutexLock lock(mutex_);
    const auto known = times_.find(entity);
    if (view.state == state_ && known != times_.end()) return known->second;
  }
  ENGRAM_ASSIGN_OR_RETURN(ltm::EntityTimes read, view.reader.times(entity));
  auto shared = std::make_shared<const ltm::EntityTimes>(std::move(read));
  const MutexLock lock(mutex_);
  if (view.state != state_) return SharedTimes(shared);
  if (times_bytes_ + shared->size_bytes() > options_.max_times_bytes) {
    times_.clear();
    times_bytes_ = 0;
  }
  if (times_.emplace(entity, shared).second) times_bytes_ += shared->size_bytes();
  return SharedTimes(shared);
}

Result<std::shared_ptr<KeptNumbers>> ViewedMemory::numbers(const StoreView& view,
                                                           const ltm::MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(SharedTimes times, this->times(view, entity));
  auto fresh = std::make_shared<KeptNumbers>(std::move(times), options_.max_numbers_bytes);
  const MutexLock lock(mutex_);
  if (view.state != state_) return fresh;
  size_t bytes = 0;
  for (const auto& [id, kept] : numbers_) bytes += kept->held_bytes();
  if (bytes > options_.max_numbers_bytes) numbers_.clear();
  return numbers_.try_emplace(entity, std::move(fresh)).first->second;
}

std::optional<idf::Type> ViewedMemory::type_of(const ltm::MemoryId& entity) {
  std::optional<idf::Type> type;
  const Status status = with_store([&](const StoreView& view) {
    const idf::Type* found = view.reader.manifest().types.of_entity(entity);
    if (found != nullptr) type = *found;
    return Status();
  });
  return status.ok() ? type : std::nullopt;
}

Result<std::vector<ltm::MemoryId>> ViewedMemory::entities() {
  std::vector<ltm::MemoryId> found;
  if (is_store()) {
    ENGRAM_RETURN_IF_ERROR(with_store([&found](const StoreView& view) {
      found = view.reader.entities();
      return Status();
    }));
    return found;
  }
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse("?ids @ latest"));
  ENGRAM_RETURN_IF_ERROR(memory_->query_parts(query, [&found](const ltm::QueryResult& part) {
    for (const ltm::EntityResult* entity : part.entities())
      if (found.empty() || found.back() != entity->id) found.push_back(entity->id);
    return Status();
  }));
  return found;
}

}  // namespace engram::viewer
