// SPDX-License-Identifier: Apache-2.0
#include "memory/live/long_term.h"

#include <atomic>
#include <map>

#include "ltm/core/mutex.h"
#include "ltm/likeness/sealed_indexer.h"
#include "ltm/store/store_reader.h"

namespace engram::memory {

using ltm::MemoryId;

struct LongTerm::State {
  using Released = std::shared_ptr<std::vector<MemoryId>>;

  State(std::filesystem::path store, ltm::Recorder opened, Released filled)
      : path(std::move(store)),
        recorder(std::move(opened)),
        released(std::move(filled)),
        lost_frames(recorder->lost_frames()) {}

  const std::filesystem::path path;
  Mutex writing;  ///< Held while the recorder is called: one commit after the other.
  std::optional<ltm::Recorder> recorder ENGRAM_GUARDED_BY(writing);
  /// What the recorder stored of earlier commits and nobody was told of. It fills this, so that
  /// `writing` guards it, too.
  const Released released;
  bool is_closed ENGRAM_GUARDED_BY(writing) = false;

  ltm::RecordedEntities recorded;
  std::atomic<uint64_t> recorded_count{0};
  std::atomic<uint64_t> refused_count{0};
  const uint64_t lost_frames;

  /// Records all at once. If one of them cannot be stored at all, each is recorded alone, so that
  /// it is the only one refused.
  Status record(std::span<const ltm::SharedSnapshot> snapshots, std::vector<Refused>& refused)
      ENGRAM_REQUIRES(writing) {
    std::vector<const ltm::CheckedSnapshot*> all;
    for (const ltm::SharedSnapshot& snapshot : snapshots) all.push_back(snapshot.get());
    const Status together = recorder->commit_checked(all);
    if (together.code() != StatusCode::kInvalidArgument) return together;
    for (size_t i = 0; i < all.size(); ++i) {
      const ltm::SharedSnapshot& snapshot = snapshots[i];
      const Status alone = recorder->commit_checked({&all[i], 1});
      if (alone.code() == StatusCode::kInvalidArgument)
        refused.push_back({snapshot, alone});
      else
        ENGRAM_RETURN_IF_ERROR(alone);
    }
    return {};
  }
};

LongTerm::LongTerm(std::unique_ptr<State> state) : state_(std::move(state)) {}
LongTerm::~LongTerm() = default;

Result<std::unique_ptr<LongTerm>> LongTerm::open(const Options& options, Clock clock,
                                                 std::shared_ptr<ltm::Redactor> redactor) {
  const auto released = std::make_shared<std::vector<MemoryId>>();
  ltm::Recorder::Options recording = options.recording;
  recording.on_released = [released](const MemoryId& snapshot) { released->push_back(snapshot); };
  // Shared with the sealer's thread, which ends with the recorder.
  const auto indexer = std::make_shared<ltm::SealedIndexer>(options.store);
  recording.store.after_seal = [indexer,
                                also = recording.store.after_seal](const std::string& file) {
    if (also) also(file);
    indexer->add(file);
  };
  ENGRAM_ASSIGN_OR_RETURN(
      auto recorder,
      ltm::Recorder::open(options.store, recording, std::move(clock), std::move(redactor)));
  return std::unique_ptr<LongTerm>(
      new LongTerm(std::make_unique<State>(options.store, std::move(recorder), released)));
}

Status LongTerm::declare(const MemoryId& segment, const idf::Type& type) {
  const MutexLock lock(state_->writing);
  if (state_->is_closed) return failed_precondition("store: is closed");
  return state_->recorder->declare(segment, type);
}

Status LongTerm::record(std::span<const ltm::SharedSnapshot> snapshots,
                        std::vector<Refused>& refused) {
  const MutexLock lock(state_->writing);
  if (state_->is_closed) return failed_precondition("store: is closed");
  // A commit may hold each entity and time once. Repeated ones go to later commits, so the last
  // counts.
  std::vector<std::vector<ltm::SharedSnapshot>> commits(1);
  std::map<MemoryId, size_t> next;
  for (const ltm::SharedSnapshot& snapshot : snapshots) {
    size_t& at = next[snapshot->id()];
    if (at == commits.size()) commits.emplace_back();
    commits[at++].push_back(snapshot);
  }
  state_->recorded.begin(snapshots);
  for (const auto& commit : commits) ENGRAM_RETURN_IF_ERROR(state_->record(commit, refused));
  state_->recorded.finish(snapshots, *state_->released);
  state_->released->clear();
  state_->recorded_count += snapshots.size() - refused.size();
  state_->refused_count += refused.size();
  return {};
}

std::map<MemoryId, TimeSet> LongTerm::waiting_times() const {
  const MutexLock lock(state_->writing);
  return state_->recorder->waiting_times();
}

void LongTerm::forget(const std::map<MemoryId, TimeSet>& gone) {
  const MutexLock lock(state_->writing);
  state_->recorder->forget(gone);
}

Status LongTerm::seal() {
  const MutexLock lock(state_->writing);
  if (state_->is_closed) return failed_precondition("store: is closed");
  return state_->recorder->seal();
}

Status LongTerm::note_forgotten(std::span<const MemoryId> entities) {
  // Nothing is recorded meanwhile, so that nothing new is taken for forgotten.
  const MutexLock lock(state_->writing);
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(state_->path));
  for (const MemoryId& entity : entities) {
    std::optional<Time> last;
    if (reader->has(entity)) {
      ENGRAM_ASSIGN_OR_RETURN(const ltm::Timeline* timeline, reader->timeline(entity));
      last = timeline->last();
    }
    state_->recorded.correct(entity, last);
  }
  return {};
}

ltm::SegmentTypes LongTerm::types() const {
  const MutexLock lock(state_->writing);
  return state_->recorder->types();
}

ltm::RecordedEntities& LongTerm::recorded() {
  return state_->recorded;
}

LongTerm::Counters LongTerm::counters() const {
  return {state_->recorded_count, state_->refused_count, state_->lost_frames};
}

Status LongTerm::close() {
  const MutexLock lock(state_->writing);
  if (state_->is_closed) return {};
  state_->is_closed = true;
  return state_->recorder->close();
}

}  // namespace engram::memory
