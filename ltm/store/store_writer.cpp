// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_writer.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <map>
#include <set>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/store/frame.h"
#include "ltm/store/journal.h"
#include "ltm/store/manifest.h"
#include "ltm/store/publish.h"
#include "ltm/store/segment_writer.h"

namespace engram::ltm {

namespace {

constexpr Duration kSealRetry = std::chrono::seconds(10);

/// Temporary files are named "<process>-<number>...": those of dead processes are left-overs.
bool belongs_to_dead_process(const std::string& name) {
  int process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  if (error != std::errc() || process <= 0) return true;
  return process != ::getpid() && ::kill(process, 0) != 0 && errno == ESRCH;
}

/// Removes what killed processes left behind: temporary files, and published files that no
/// manifest names.
Status remove_leftovers(const std::filesystem::path& store) {
  // Copies of a store leave out empty folders.
  for (const char* folder : {"journal", "segments", "models", "tmp"})
    ENGRAM_RETURN_IF_ERROR(make_directories(store / folder));
  for (const auto& entry : std::filesystem::directory_iterator(store / "tmp"))
    if (belongs_to_dead_process(entry.path().filename().string()))
      ENGRAM_RETURN_IF_ERROR(remove_file(entry.path()));
  return edit_manifest(store, [&store](Manifest& manifest) -> Status {
    std::set<std::string> named;
    for (const SegmentInfo& segment : manifest.segments) named.insert(segment.file);
    for (const ModelInfo& model : manifest.models) named.insert(model.file);
    for (const char* folder : {"segments", "models"})
      for (const auto& entry : std::filesystem::directory_iterator(store / folder))
        if (!named.contains(folder + ("/" + entry.path().filename().string())))
          ENGRAM_RETURN_IF_ERROR(remove_file(entry.path()));
    ENGRAM_ASSIGN_OR_RETURN(const auto journals, list_journals(store));
    for (const uint64_t number : journals)
      if (number < manifest.first_journal)
        ENGRAM_RETURN_IF_ERROR(remove_file(store / Journal::file_name(number)));
    return {};
  });
}

}  // namespace

struct StoreWriter::State {
  std::filesystem::path path;
  Options options;
  Clock clock;
  File lock;
  std::optional<Journal> journal;  ///< Nothing until the first append after a seal.
  uint64_t next_journal = 1;
  uint64_t unsealed_bytes = 0;
  std::optional<Time> oldest_unsealed;  ///< By the clock, when it was appended.
  std::optional<Time> seal_retry;
  Time last_sync{};
  std::map<MemoryId, Time> last_times;
  SegmentTypes types;
  uint64_t damaged = 0;

  State(std::filesystem::path store, const Options& chosen, Clock now, File writer_lock)
      : path(std::move(store)),
        options(chosen),
        clock(std::move(now)),
        lock(std::move(writer_lock)) {}

  void note_time(const MemoryId& entity, Time time) {
    const auto [known, is_new] = last_times.emplace(entity, time);
    if (!is_new) known->second = std::max(known->second, time);
  }

  Status take_over() {
    ENGRAM_RETURN_IF_ERROR(remove_leftovers(path));
    ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(path));
    for (const SegmentInfo& segment : manifest.segments)
      for (const SegmentEntity& entity : segment.entities)
        if (entity.snapshots > 0) note_time(entity.id, entity.last);
    types = manifest.types;
    next_journal = manifest.first_journal;
    ENGRAM_ASSIGN_OR_RETURN(const auto journals, list_journals(path));
    for (const uint64_t number : journals) {
      next_journal = std::max(next_journal, number + 1);
      const auto scan = scan_journal(
          path / Journal::file_name(number), [this](uint64_t, const Buffer& payload) -> Status {
            ENGRAM_ASSIGN_OR_RETURN(const FrameHead head, decode_frame_head(payload));
            if (head.instances > 0) note_time(head.entity, head.time);
            unsealed_bytes += payload.size();
            return {};
          });
      ENGRAM_RETURN_IF_ERROR(scan.status());
      damaged += scan->damaged;
    }
    if (unsealed_bytes > 0) oldest_unsealed = clock();
    if (damaged > 0)
      log::warning("store '{}': {} damaged places in the journal; what was there is lost",
                   path.string(), damaged);
    return {};
  }

  Status open_journal() {
    if (journal) return {};
    ENGRAM_ASSIGN_OR_RETURN(Journal made, Journal::create(path, next_journal));
    ++next_journal;
    journal = std::move(made);
    return {};
  }

  Status append_frames(const std::vector<std::vector<std::byte>>& payloads) {
    ENGRAM_RETURN_IF_ERROR(open_journal());
    ENGRAM_RETURN_IF_ERROR(journal->append(payloads));
    for (const auto& payload : payloads) unsealed_bytes += payload.size();
    const Time now = clock();
    if (!oldest_unsealed) oldest_unsealed = now;
    const bool is_sync_due =
        options.durability == Durability::kEvery ||
        (options.durability == Durability::kInterval && now - last_sync >= options.sync_interval);
    if (is_sync_due) {
      ENGRAM_RETURN_IF_ERROR(journal->sync());
      last_sync = now;
    }
    return {};
  }

  [[nodiscard]] bool is_seal_due() const {
    if (!oldest_unsealed || (seal_retry && clock() < *seal_retry)) return false;
    return unsealed_bytes >= options.seal_bytes || clock() - *oldest_unsealed >= options.seal_after;
  }

  /// Seals where it is due. What was appended is acknowledged whether this works or not: the
  /// journal holds it, and sealing is tried again later.
  void seal_if_due() {
    if (!is_seal_due()) return;
    const Status status = seal();
    seal_retry = status.ok() ? std::nullopt : std::optional(clock() + kSealRetry);
    if (!status.ok())
      log::warning("store '{}': sealing failed, the journal keeps all: {}", path.string(),
                   status.to_string());
  }

  struct JournalContent {
    std::map<MemoryId, RecordedEntity> entities;
    std::set<uint64_t> damaged_journals;
    uint64_t damaged = 0;
  };

  Result<JournalContent> read_journals(const std::vector<uint64_t>& numbers) {
    JournalContent content;
    auto& entities = content.entities;
    for (const uint64_t number : numbers) {
      const auto scan = scan_journal(
          path / Journal::file_name(number), [&](uint64_t, const Buffer& payload) -> Status {
            ENGRAM_ASSIGN_OR_RETURN(PackedSnapshot snapshot, decode_frame(payload));
            RecordedEntity& entity = entities[snapshot.entity];
            if (snapshot.instances.empty()) {
              entity.trailing_dropped += snapshot.dropped;
              entity.trailing_dropped_bytes += snapshot.dropped_bytes;
            } else {
              entity.snapshots.push_back(std::move(snapshot));
            }
            return {};
          });
      ENGRAM_RETURN_IF_ERROR(scan.status());
      if (scan->damaged > 0) content.damaged_journals.insert(number);
      content.damaged += scan->damaged;
    }
    for (auto& [id, entity] : entities) keep_last_of_each_time(entity.snapshots);
    return content;
  }

  /// An append whose sync failed was not acknowledged and may have been tried again.
  static void keep_last_of_each_time(std::vector<PackedSnapshot>& snapshots) {
    std::ranges::stable_sort(snapshots, {}, &PackedSnapshot::time);
    const auto is_superseded = [](const PackedSnapshot& a, const PackedSnapshot& b) {
      return a.time == b.time;
    };
    // unique keeps the first of a run: walk from the back to keep the last.
    const auto [kept_end, end] =
        std::ranges::unique(snapshots.rbegin(), snapshots.rend(), is_superseded);
    snapshots.erase(snapshots.begin(), kept_end.base());
  }

  Status publish_segment(const std::filesystem::path& file, const JournalContent& content) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentInfo segment, write_recorded_segment(file, content.entities, types));
    return edit_manifest(path, [&](Manifest& manifest) -> Status {
      segment.file = fmt::format("segments/{:06}.h5", manifest.next_segment++);
      ENGRAM_RETURN_IF_ERROR(publish_file(file, path / segment.file));
      manifest.segments.push_back(std::move(segment));
      manifest.first_journal = next_journal;
      manifest.damaged += content.damaged;
      return {};
    });
  }

  Status seal() {
    ENGRAM_ASSIGN_OR_RETURN(const auto numbers, list_journals(path));
    ENGRAM_ASSIGN_OR_RETURN(const JournalContent content, read_journals(numbers));
    if (!content.entities.empty() || content.damaged > 0) {
      ENGRAM_ASSIGN_OR_RETURN(const std::filesystem::path file, temporary_file(path, ".h5"));
      if (Status status = publish_segment(file, content); !status.ok()) {
        // It is tried again and again: what failed must not fill the disk.
        const Status removed = remove_file(file);
        return removed.ok() ? status : status.with_context(removed.message());
      }
    }
    // From here on the segment is the truth; a journal that stays behind is removed at the next
    // opening. Damaged journals are kept for whoever wants to look at what was lost.
    journal.reset();
    unsealed_bytes = 0;
    oldest_unsealed.reset();
    for (const uint64_t number : numbers) {
      const std::filesystem::path file = path / Journal::file_name(number);
      ENGRAM_RETURN_IF_ERROR(content.damaged_journals.contains(number)
                                 ? publish_file(file, file.string() + ".damaged")
                                 : remove_file(file));
    }
    return {};
  }
};

StoreWriter::StoreWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}

StoreWriter::~StoreWriter() {
  // The journal keeps what is not sealed; a power cut after this must not cost it.
  if (state_->journal && !state_->journal->sync().ok())
    log::warning("store '{}': the journal could not be forced to disk", state_->path.string());
}

Result<std::unique_ptr<StoreWriter>> StoreWriter::open(const std::filesystem::path& store,
                                                       const Options& options, Clock clock) {
  ENGRAM_RETURN_IF_ERROR(read_manifest(store).status());
  ENGRAM_ASSIGN_OR_RETURN(File lock, File::open(store / "WRITER.lock", File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, lock.lock(false));
  if (!is_locked)
    return failed_precondition("store '{}': another process is writing to it", store.string());
  auto state = std::make_unique<State>(store, options, std::move(clock), std::move(lock));
  ENGRAM_RETURN_IF_ERROR(state->take_over());
  return std::unique_ptr<StoreWriter>(new StoreWriter(std::move(state)));
}

Status StoreWriter::append(const std::vector<PackedSnapshot>& snapshots,
                           std::vector<uint64_t>* frame_bytes) {
  std::map<MemoryId, Time> times;
  std::vector<std::vector<std::byte>> payloads;
  for (const PackedSnapshot& snapshot : snapshots) {
    const std::string id = snapshot.entity.to_string();
    if (!snapshot.entity.is_entity())
      return invalid_argument("commit: '{}' is no entity: needs four names", id);
    if (snapshot.instances.empty())
      return invalid_argument("commit: snapshot '{}' has no instances, needs at least one",
                              snapshot.entity.at(snapshot.time).to_string());
    const auto pending = times.find(snapshot.entity);
    const std::optional<Time> last =
        pending != times.end() ? pending->second : last_time(snapshot.entity);
    if (last && snapshot.time <= *last)
      return invalid_argument("entity '{}': time runs backwards: found {}, needs one after {}", id,
                              to_string(snapshot.time), to_string(*last));
    for (const PackedInstance& instance : snapshot.instances)
      if (instance.metadata.provider.find('\0') != std::string::npos)
        return invalid_argument("commit: snapshot '{}': its provider's name has a zero byte",
                                snapshot.entity.at(snapshot.time).to_string());
    times[snapshot.entity] = snapshot.time;
    ENGRAM_ASSIGN_OR_RETURN(auto payload, encode_frame(snapshot));
    payloads.push_back(std::move(payload));
  }
  if (payloads.empty()) return {};
  ENGRAM_RETURN_IF_ERROR(state_->append_frames(payloads));
  for (const auto& [entity, time] : times) state_->note_time(entity, time);
  if (frame_bytes != nullptr)
    for (const auto& payload : payloads)
      frame_bytes->push_back(payload.size() + Journal::kFrameOverheadBytes);
  state_->seal_if_due();
  return {};
}

Status StoreWriter::append_dropped(const MemoryId& entity, uint64_t dropped,
                                   uint64_t dropped_bytes) {
  if (!entity.is_entity())
    return invalid_argument("'{}' is no entity: needs four names", entity.to_string());
  PackedSnapshot note;
  note.entity = entity;
  note.dropped = dropped;
  note.dropped_bytes = dropped_bytes;
  ENGRAM_ASSIGN_OR_RETURN(auto payload, encode_frame(note));
  return state_->append_frames({std::move(payload)});
}

Status StoreWriter::declare(const MemoryId& segment, const idf::Type& type) {
  const idf::Type* known = state_->types.find(segment);
  if (known != nullptr && *known == type) return {};
  SegmentTypes types = state_->types;
  ENGRAM_RETURN_IF_ERROR(types.declare(segment, type));
  ENGRAM_RETURN_IF_ERROR(state_->seal());
  ENGRAM_RETURN_IF_ERROR(edit_manifest(state_->path, [&types](Manifest& manifest) -> Status {
    manifest.types = types;
    return {};
  }));
  state_->types = std::move(types);
  return {};
}

const SegmentTypes& StoreWriter::types() const {
  return state_->types;
}

Status StoreWriter::seal() {
  return state_->seal();
}

std::optional<Time> StoreWriter::last_time(const MemoryId& entity) const {
  const auto known = state_->last_times.find(entity);
  return known == state_->last_times.end() ? std::nullopt : std::optional(known->second);
}

uint64_t StoreWriter::lost_frames() const {
  return state_->damaged;
}

}  // namespace engram::ltm
