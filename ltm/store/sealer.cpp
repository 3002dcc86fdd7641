// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/sealer.h"

#include <map>
#include <set>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/store/frame.h"
#include "ltm/store/journal.h"
#include "ltm/store/last_of_each_time.h"
#include "ltm/store/manifest.h"
#include "ltm/store/publish.h"
#include "ltm/store/segment_writer.h"

namespace engram::ltm {

namespace {

struct JournalContent {
  std::map<MemoryId, RecordedEntity> entities;
  std::set<uint64_t> damaged_journals;
  uint64_t damaged = 0;

  void add(PackedSnapshot snapshot) {
    RecordedEntity& entity = entities[snapshot.entity];
    if (!snapshot.instances.empty()) {
      entity.snapshots.push_back(std::move(snapshot));
      return;
    }
    entity.trailing_dropped += snapshot.dropped;
    entity.trailing_dropped_bytes += snapshot.dropped_bytes;
  }
};

Result<JournalContent> read_journals(const std::filesystem::path& store,
                                     const std::vector<uint64_t>& numbers) {
  JournalContent content;
  for (const uint64_t number : numbers) {
    const auto scan = scan_journal(store / Journal::file_name(number),
                                   [&content](uint64_t, const Buffer& payload) -> Status {
                                     ENGRAM_ASSIGN_OR_RETURN(auto snapshot, decode_frame(payload));
                                     content.add(std::move(snapshot));
                                     return {};
                                   });
    ENGRAM_RETURN_IF_ERROR(scan.status());
    if (scan->damaged > 0) content.damaged_journals.insert(number);
    content.damaged += scan->damaged;
  }
  for (auto& [id, entity] : content.entities) keep_last_of_each_time(entity.snapshots);
  return content;
}

Result<std::string> publish_segment(const std::filesystem::path& store,
                                    const std::filesystem::path& file,
                                    const JournalContent& content, const Sealer::Job& job) {
  ENGRAM_ASSIGN_OR_RETURN(SegmentInfo segment,
                          write_recorded_segment(file, content.entities, job.types));
  std::string name;
  ENGRAM_RETURN_IF_ERROR(edit_manifest(store, [&](Manifest& manifest) -> Status {
    segment.file = fmt::format("segments/{:06}.h5", manifest.next_segment++);
    segment.last_journal = job.journals.back();
    ENGRAM_RETURN_IF_ERROR(publish_file(file, store / segment.file));
    name = segment.file;
    manifest.segments.push_back(std::move(segment));
    manifest.first_journal = job.journals.back() + 1;
    manifest.damaged += content.damaged;
    for (const auto& [entity, reasons] : job.dropped_by)
      for (const auto& [filter, count] : reasons) manifest.dropped_by[entity][filter] += count;
    return {};
  }));
  return name;
}

}  // namespace

Result<std::string> seal_journals(const std::filesystem::path& store, const Sealer::Job& job) {
  ENGRAM_ASSIGN_OR_RETURN(JournalContent content, read_journals(store, job.journals));
  if (job.rules)
    for (auto& [id, entity] : content.entities) entity.rules = job.rules(id);
  std::string published;
  if (!content.entities.empty() || content.damaged > 0) {
    // The temporary file is removed after an error, because sealing is retried and failed attempts
    // must not fill the disk.
    ENGRAM_ASSIGN_OR_RETURN(const TemporaryFile file, TemporaryFile::create(store, ".h5"));
    ENGRAM_ASSIGN_OR_RETURN(published, publish_segment(store, file.path(), content, job));
  }
  // From here on the segment is authoritative. A journal that remains is removed when the store is
  // next opened. Damaged journals are kept so that the lost places can be inspected.
  for (const uint64_t number : job.journals) {
    const std::filesystem::path file = store / Journal::file_name(number);
    if (!content.damaged_journals.contains(number)) {
      ENGRAM_RETURN_IF_ERROR(Journal::remove(store, number));
      continue;
    }
    ENGRAM_RETURN_IF_ERROR(publish_file(file, file.string() + ".damaged"));
    ENGRAM_RETURN_IF_ERROR(remove_file(acknowledged_mark_of(file)));
  }
  return published;
}

Sealer::Sealer(std::filesystem::path store, const Options& options)
    : store_(std::move(store)),
      options_(options),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Sealer::~Sealer() = default;

void Sealer::run(const std::stop_token& stop) {
  MutexLock lock(mutex_);
  while (changed_.wait(mutex_, stop, [this]() ENGRAM_REQUIRES(mutex_) { return !jobs_.empty(); }) &&
         !stop.stop_requested()) {
    const Job job = jobs_.front();
    // Sealing encodes and syncs whole journals, so it runs without the lock; otherwise `add` would
    // block the writer. The job stays in the queue until it succeeds, so that `finish` waits for
    // it.
    lock.unlock();
    const auto sealed = seal_journals(store_, job);
    Status status = sealed.status();
    if (sealed.ok() && !sealed->empty() && options_.after_seal) options_.after_seal(*sealed);
    if (!status.ok())
      log::warning("store '{}': sealing failed, the journal keeps all: {}", store_.string(),
                   status.to_string());
    lock.lock();
    if (status.ok()) jobs_.pop_front();
    last_ = std::move(status);
    ++attempts_;
    changed_.notify_all();
    if (!last_.ok()) {
      const uint64_t hurries = hurries_;
      changed_.wait_for(mutex_, stop, options_.retry_after,
                        [this, hurries]() ENGRAM_REQUIRES(mutex_) { return hurries_ != hurries; });
    }
  }
}

void Sealer::add(Job job) {
  const MutexLock lock(mutex_);
  jobs_.push_back(std::move(job));
  changed_.notify_all();
}

void Sealer::wait_below(size_t count) {
  const MutexLock lock(mutex_);
  changed_.wait(mutex_,
                [&]() ENGRAM_REQUIRES(mutex_) { return jobs_.size() < count || !last_.ok(); });
}

Status Sealer::finish() {
  const MutexLock lock(mutex_);
  ++hurries_;
  changed_.notify_all();
  while (!jobs_.empty()) {
    const uint64_t attempts = attempts_;
    changed_.wait(mutex_, [&]() ENGRAM_REQUIRES(mutex_) { return attempts_ != attempts; });
    if (!last_.ok()) return last_;
  }
  return {};
}

}  // namespace engram::ltm
