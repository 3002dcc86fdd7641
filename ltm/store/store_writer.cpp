// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_writer.h"

#include <algorithm>
#include <map>
#include <set>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/entity_index.h"
#include "ltm/store/frame.h"
#include "ltm/store/journal.h"
#include "ltm/store/journal_syncer.h"
#include "ltm/store/manifest.h"
#include "ltm/store/publish.h"
#include "ltm/store/sealer.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

/// Name of a metadata text with a zero byte, which cannot be stored; empty if there is none.
std::string_view text_with_zero_byte(const InstanceMetadata& metadata) {
  if (metadata.provider.find('\0') != std::string::npos) return "provider's name";
  if (metadata.recipe.find('\0') != std::string::npos) return "recipe";
  return metadata.origin.to_string().find('\0') != std::string::npos ? "origin" : "";
}

/// Removes notes whose journal is gone. Where nobody sealed it, what it held is lost.
Status remove_marks(const std::filesystem::path& store, const std::vector<uint64_t>& journals,
                    Manifest& manifest) {
  ENGRAM_ASSIGN_OR_RETURN(const auto marks, list_acknowledged_marks(store));
  for (const uint64_t number : marks) {
    const bool is_sealed = number < manifest.first_journal;
    if (!is_sealed && std::ranges::binary_search(journals, number)) continue;
    const auto forced = acknowledged_bytes(store / Journal::file_name(number));
    if (!is_sealed && forced) {
      ++manifest.damaged;
      log::warning("store '{}': journal {} is missing; {} bytes of it were forced to the disk",
                   store.string(), number, *forced);
    }
    ENGRAM_RETURN_IF_ERROR(Journal::remove(store, number));
  }
  return {};
}

/// Removes files that killed processes left: temporary files, and published files that the manifest
/// does not name.
Status remove_leftovers(const std::filesystem::path& store) {
  // Some copies of a store omit empty folders.
  for (const char* folder : {"journal", "segments", "models", "tmp"})
    ENGRAM_RETURN_IF_ERROR(make_directories(store / folder));
  for (const auto& entry : std::filesystem::directory_iterator(store / "tmp"))
    if (const std::string name = entry.path().filename().string();
        !is_checkpoint(name) && !is_history(name) && belongs_to_dead_process(name))
      ENGRAM_RETURN_IF_ERROR(remove_file(entry.path()));
  return edit_manifest(store, [&store](Manifest& manifest) -> Status {
    std::set<std::string> named;
    for (const SegmentInfo& segment : manifest.segments) named.insert(segment.file);
    for (const ModelInfo& model : manifest.models) named.insert(model.file);
    for (const char* folder : {"segments", "models"})
      for (const auto& entry : std::filesystem::directory_iterator(store / folder))
        if (!named.contains(folder + ("/" + entry.path().filename().string())))
          ENGRAM_RETURN_IF_ERROR(remove_file(entry.path()));
    for (const std::string& file : find_stray_indexes(store, manifest))
      ENGRAM_RETURN_IF_ERROR(remove_file(store / file));
    ENGRAM_ASSIGN_OR_RETURN(const auto journals, list_journals(store));
    for (const uint64_t number : journals)
      if (number < manifest.first_journal) ENGRAM_RETURN_IF_ERROR(Journal::remove(store, number));
    return remove_marks(store, journals, manifest);
  });
}

}  // namespace

struct StoreWriter::State {
  std::filesystem::path path;
  Options options;
  Clock clock;
  File lock;
  std::shared_ptr<Journal> journal;  ///< Null until the first append after it was closed.
  /// Closed journals that were not handed to the sealer yet.
  std::vector<uint64_t> closed_journals;
  uint64_t next_journal = 1;
  uint64_t first_own = 1;     ///< The first journal of this session.
  bool has_unforced = false;  ///< Data was appended without fsync since the last `sync` or `seal`.
  uint64_t unsealed_bytes = 0;  ///< Size of the unsealed journals.
  /// Time by the clock at which the oldest unsealed snapshot was appended.
  std::optional<Time> oldest_unsealed;
  /// What the segments have of entities when the store is opened, asked for one at a time.
  mutable EntityIndex sealed;
  /// Of entities that were asked for, appended, or in journals. Empty: no snapshot yet.
  mutable std::map<MemoryId, std::optional<Time>> last_times;
  SegmentTypes types;
  std::map<MemoryId, DropReasons> dropped_by;  ///< Drop reasons since the last job of the sealer.
  uint64_t damaged = 0;
  std::optional<JournalSyncer> syncer;
  std::optional<Sealer> sealer;

  State(std::filesystem::path store, const Options& chosen, Clock now, File writer_lock)
      : path(std::move(store)),
        options(chosen),
        clock(std::move(now)),
        lock(std::move(writer_lock)) {}

  std::optional<Time>& last_time(const MemoryId& entity) const {
    const auto [known, is_new] = last_times.try_emplace(entity);
    if (is_new) known->second = last_time_in(sealed.of(entity));
    return known->second;
  }

  void note_time(const MemoryId& entity, Time time) {
    std::optional<Time>& last = last_time(entity);
    last = std::max(last.value_or(time), time);
  }

  Status take_over() {
    ENGRAM_RETURN_IF_ERROR(remove_leftovers(path));
    ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(path));
    sealed = EntityIndex(manifest.segments);
    types = manifest.types;
    next_journal = manifest.first_journal;
    ENGRAM_ASSIGN_OR_RETURN(const auto journals, list_journals(path));
    for (const uint64_t number : journals) ENGRAM_RETURN_IF_ERROR(take_over(number));
    first_own = next_journal;
    if (unsealed_bytes > 0) oldest_unsealed = clock();
    if (damaged > 0)
      log::warning("store '{}': {} damaged places in the journal; what was there is lost",
                   path.string(), damaged);
    sealer.emplace(path, Sealer::Options{.after_seal = options.after_seal});
    if (options.durability == Durability::kInterval) syncer.emplace(options.sync_interval);
    return {};
  }

  Status take_over(uint64_t number) {
    next_journal = std::max(next_journal, number + 1);
    closed_journals.push_back(number);
    const auto scan = scan_journal(
        path / Journal::file_name(number), [this](uint64_t, const Buffer& payload) -> Status {
          ENGRAM_ASSIGN_OR_RETURN(const FrameHead head, decode_frame_head(payload));
          if (head.instances > 0) note_time(head.entity, head.time);
          unsealed_bytes += payload.size();
          return {};
        });
    ENGRAM_RETURN_IF_ERROR(scan.status());
    damaged += scan->damaged;
    return {};
  }

  /// Fails before the disk is full; on a full disk the journals could not even be sealed.
  Status check_disk() const {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t free, free_disk_bytes(path));
    if (free >= options.min_free_bytes) return {};
    return resource_exhausted("store '{}': the disk has {} bytes left, recording needs {}",
                              path.string(), free, options.min_free_bytes);
  }

  /// Says at the start what would come as a surprise later.
  void tell_of_disk() const {
    const auto free = free_disk_bytes(path);
    if (free.ok() && *free < 2 * options.min_free_bytes)
      log::warning("store '{}': the disk has {} bytes left; nothing is recorded below {}",
                   path.string(), *free, options.min_free_bytes);
  }

  Status open_journal() {
    if (journal) return {};
    ENGRAM_ASSIGN_OR_RETURN(Journal made, Journal::create(path, next_journal));
    ++next_journal;
    journal = std::make_shared<Journal>(std::move(made));
    return {};
  }

  Status append_frames(const std::vector<std::vector<std::byte>>& payloads) {
    ENGRAM_RETURN_IF_ERROR(check_disk());
    if (syncer) ENGRAM_RETURN_IF_ERROR(syncer->take_error());
    ENGRAM_RETURN_IF_ERROR(open_journal());
    ENGRAM_RETURN_IF_ERROR(journal->append(payloads));
    for (const auto& payload : payloads) unsealed_bytes += payload.size();
    if (!oldest_unsealed) oldest_unsealed = clock();
    if (options.durability == Durability::kEvery) return journal->sync(journal->size_bytes());
    has_unforced = true;
    if (syncer) syncer->note_append(journal, journal->size_bytes());
    return {};
  }

  [[nodiscard]] bool is_seal_due() const {
    if (!oldest_unsealed) return false;
    return unsealed_bytes >= options.seal_bytes || clock() - *oldest_unsealed >= options.seal_after;
  }

  void add_job(std::vector<uint64_t> journals, const SealRulesOf& rules) {
    if (journals.empty()) return;
    sealer->add({std::move(journals), unsealed_bytes, types, std::exchange(dropped_by, {}), rules});
  }

  /// Hands all journals to the sealer. The next append starts a new one.
  void hand_over() {
    if (journal) closed_journals.push_back(journal->number());
    journal.reset();
    const auto own = std::ranges::lower_bound(closed_journals, first_own);
    // The rules of another session are unknown, so its journals are sealed as they are.
    if (options.seal_rules) add_job({closed_journals.begin(), own}, {});
    add_job({options.seal_rules ? own : closed_journals.begin(), closed_journals.end()},
            options.seal_rules);
    closed_journals.clear();
    unsealed_bytes = 0;
    oldest_unsealed.reset();
  }

  /// Seals if due. The result does not affect the append: the journal holds the data even if
  /// sealing fails.
  void seal_if_due() {
    if (!is_seal_due()) return;
    sealer->wait_below(static_cast<size_t>(options.max_waiting_journals));
    hand_over();
  }

  Status seal() {
    hand_over();
    ENGRAM_RETURN_IF_ERROR(sealer->finish());
    has_unforced = false;
    return {};
  }

  Status sync() {
    if (!std::exchange(has_unforced, false)) return {};
    const Status status = sync_journals();
    const Status regular = syncer ? syncer->take_error() : Status();
    return status.ok() ? regular : status;
  }

  /// Forces the unsealed journals of this session to the disk. One of them may be sealed and
  /// removed meanwhile.
  Status sync_journals() const {
    ENGRAM_ASSIGN_OR_RETURN(const auto numbers, list_journals(path));
    Status first;
    for (const uint64_t number : numbers) {
      if (number < first_own) continue;
      auto file = File::open(path / Journal::file_name(number), File::Mode::kRead);
      if (file.status().code() == StatusCode::kNotFound) continue;
      Status status = file.ok() ? file->sync() : file.status();
      if (first.ok()) first = std::move(status);
    }
    return first;
  }
};

Status StoreWriter::Options::validate() const {
  if (sync_interval <= Duration(0)) return invalid_argument("sync_interval: needs more than 0");
  if (seal_bytes == 0) return invalid_argument("seal_bytes: needs more than 0");
  if (seal_after <= Duration(0)) return invalid_argument("seal_after: needs more than 0");
  if (max_waiting_journals < 1)
    return invalid_argument("max_waiting_journals: found {}, needs at least 1",
                            max_waiting_journals);
  return {};
}

StoreWriter::StoreWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}

StoreWriter::~StoreWriter() {
  if (const Status status = state_->sync(); !status.ok())
    log::warning("store '{}': a power cut may cost what was appended last: {}",
                 state_->path.string(), status.to_string());
}

bool StoreWriter::is_open(const std::filesystem::path& store) {
  auto lock = File::open(store / kWriterLock, File::Mode::kRead);
  if (!lock.ok()) return false;
  const auto is_free = lock->lock(false, File::LockKind::kShared);
  return is_free.ok() && !*is_free;
}

Result<std::unique_ptr<StoreWriter>> StoreWriter::open(const std::filesystem::path& store,
                                                       const Options& options, Clock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_RETURN_IF_ERROR(read_manifest(store).status());
  ENGRAM_ASSIGN_OR_RETURN(File lock, File::open(store / kWriterLock, File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, lock.lock(false));
  if (!is_locked)
    return failed_precondition("store '{}': another process is writing to it", store.string());
  auto state = std::make_unique<State>(store, options, std::move(clock), std::move(lock));
  ENGRAM_RETURN_IF_ERROR(state->take_over());
  state->tell_of_disk();
  return std::unique_ptr<StoreWriter>(new StoreWriter(std::move(state)));
}

Status StoreWriter::append(const std::vector<PackedSnapshot>& snapshots,
                           std::vector<uint64_t>* frame_bytes) {
  std::vector<std::vector<std::byte>> payloads;
  for (const PackedSnapshot& snapshot : snapshots) {
    const std::string id = snapshot.entity.to_string();
    if (!snapshot.entity.is_entity())
      return invalid_argument("commit: '{}' is no entity: needs four names", id);
    if (snapshot.instances.empty())
      return invalid_argument("commit: snapshot '{}' has no instances, needs at least one",
                              snapshot.entity.at(snapshot.time).to_string());
    for (const auto& [value, metadata] : snapshot.instances)
      if (const std::string_view found = text_with_zero_byte(metadata); !found.empty())
        return invalid_argument("commit: snapshot '{}': its {} has a zero byte",
                                snapshot.entity.at(snapshot.time).to_string(), found);
    ENGRAM_ASSIGN_OR_RETURN(auto payload, encode_frame(snapshot));
    payloads.push_back(std::move(payload));
  }
  if (payloads.empty()) return {};
  ENGRAM_RETURN_IF_ERROR(state_->append_frames(payloads));
  for (const PackedSnapshot& snapshot : snapshots)
    state_->note_time(snapshot.entity, snapshot.time);
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

void StoreWriter::note_dropped_by(const MemoryId& entity, std::string_view filter, uint64_t count) {
  state_->dropped_by[entity][std::string(filter)] += count;
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

Status StoreWriter::sync() {
  return state_->sync();
}

std::optional<Time> StoreWriter::last_time(const MemoryId& entity) const {
  return state_->last_time(entity);
}

uint64_t StoreWriter::lost_frames() const {
  return state_->damaged;
}

}  // namespace engram::ltm
