// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_reader.h"

#include <algorithm>
#include <list>
#include <map>

#include "ltm/core/file.h"
#include "ltm/store/entity_index.h"
#include "ltm/store/frame.h"
#include "ltm/store/journal.h"
#include "ltm/store/last_of_each_time.h"
#include "ltm/store/segment_reader.h"

namespace engram::ltm {

namespace {

/// Max number of open segments. Each keeps its last windows of rows in memory.
constexpr size_t kMaxOpenSegments = 64;

/// Max attempts to open the store. A writer may seal and remove a journal meanwhile.
constexpr int kOpenAttempts = 100;

/// Number of newest segments that are inspected to find how an entity is stored.
constexpr int kSegmentsForForms = 4;

struct JournalEntry {
  uint32_t journal = 0;
  uint64_t offset = 0;
  uint64_t frame_bytes = 0;
  FrameHead head;
};

}  // namespace

struct StoreReader::State {
  std::filesystem::path path;
  Manifest manifest;
  std::vector<File> journals;
  std::vector<uint64_t> journal_numbers;  ///< Of each of `journals`.
  std::map<MemoryId, std::vector<JournalEntry>> journal_entries;
  /// Drops after the last frame, and their bytes.
  std::map<MemoryId, std::pair<uint64_t, uint64_t>> journal_trailing;
  uint64_t journal_damaged = 0;
  /// Most recently used first.
  std::list<std::pair<uint32_t, std::unique_ptr<SegmentReader>>> segments;
  EntityIndex stored;
  std::map<MemoryId, std::vector<const ModelInfo*>> models;
  std::map<MemoryId, Timeline> timelines;
  std::map<MemoryId, std::vector<SnapshotEntry>> indices;
  MediumDecoder decoder;

  Status load() {
    ENGRAM_ASSIGN_OR_RETURN(manifest, read_manifest(path));
    stored = EntityIndex(manifest.segments);
    for (const ModelInfo& model : manifest.models) models[model.entity].push_back(&model);
    ENGRAM_ASSIGN_OR_RETURN(const auto numbers, list_journals(path));
    for (const uint64_t number : numbers) {
      if (number < manifest.first_journal) continue;
      const std::filesystem::path file = path / Journal::file_name(number);
      ENGRAM_ASSIGN_OR_RETURN(File journal, File::open(file, File::Mode::kRead));
      const auto index = static_cast<uint32_t>(journals.size());
      const auto scan = scan_journal(file, [&](uint64_t offset, const Buffer& payload) -> Status {
        ENGRAM_ASSIGN_OR_RETURN(FrameHead head, decode_frame_head(payload));
        add(index, offset, payload.size() + Journal::kFrameOverheadBytes, std::move(head));
        return {};
      });
      ENGRAM_RETURN_IF_ERROR(scan.status());
      journal_damaged += scan->damaged;
      journals.push_back(std::move(journal));
      journal_numbers.push_back(number);
    }
    return {};
  }

  /// The entity's frames in the order of time. Of frames with equal times the last one counts.
  [[nodiscard]] std::vector<SnapshotEntry> journal_snapshots(const MemoryId& entity) const {
    std::vector<SnapshotEntry> entries;
    const auto frames = journal_entries.find(entity);
    if (frames == journal_entries.end()) return entries;
    for (const JournalEntry& frame : frames->second)
      entries.push_back(
          {frame.head.time, SnapshotEntry::Location{frame.journal, 0, frame.offset}, {}});
    keep_last_of_each_time(entries);
    return entries;
  }

  void add(uint32_t journal, uint64_t offset, uint64_t frame_bytes, FrameHead head) {
    const MemoryId entity = head.entity;
    if (head.instances == 0) {
      auto& [dropped, bytes] = journal_trailing[entity];
      dropped += head.dropped;
      bytes += head.dropped_bytes;
      return;
    }
    journal_entries[entity].push_back({journal, offset, frame_bytes, std::move(head)});
  }

  Result<SegmentReader*> segment(uint32_t number) {
    const auto known = std::ranges::find(segments, number, &decltype(segments)::value_type::first);
    if (known != segments.end()) {
      segments.splice(segments.begin(), segments, known);
    } else {
      auto opened = SegmentReader::open(path / manifest.segments[number].file);
      if (opened.status().code() == StatusCode::kNotFound)
        return missing(manifest.segments[number].file);
      if (!opened.ok()) return opened.status();
      segments.emplace_front(number, std::move(opened).value());
      if (segments.size() > kMaxOpenSegments) segments.pop_back();
    }
    return segments.front().second.get();
  }

  /// The error for a missing segment. A segment that a later generation no longer names may be
  /// removed while this reader is open.
  [[nodiscard]] Status missing(const std::string& file) const {
    const auto now = read_manifest(path);
    if (now.ok() &&
        std::ranges::find(now->segments, file, &SegmentInfo::file) == now->segments.end())
      return unavailable("store '{}': segment '{}' was replaced meanwhile: open the store again",
                         path.string(), file);
    return data_loss("store '{}': segment '{}' is missing", path.string(), file);
  }

  [[nodiscard]] bool has(const MemoryId& entity) {
    return journal_entries.contains(entity) || !stored.of(entity).empty();
  }

  Status no_such_entity(const MemoryId& entity, const std::vector<MemoryId>& known) const {
    constexpr size_t kMaxNamed = 20;
    std::string names;
    for (size_t i = 0; i < known.size() && i < kMaxNamed; ++i)
      names += (names.empty() ? "" : ", ") + known[i].to_string();
    if (known.size() > kMaxNamed) names += fmt::format(" and {} more", known.size() - kMaxNamed);
    return not_found("store '{}' has no entity '{}'; it has: {}", path.string(), entity.to_string(),
                     names.empty() ? "none" : names);
  }

  /// The timeline of the entity's recorded form, its latents, or both.
  Timeline make_timeline(const MemoryId& entity, bool is_recorded, bool is_latent) {
    std::vector<TimelinePart> some;
    for (const auto& [segment, part] : stored.of(entity)) {
      const bool is_of_latents = manifest.segments[segment].kind == SegmentKind::kLatent;
      if (part->snapshots > 0 && (is_of_latents ? is_latent : is_recorded))
        some.push_back(
            {segment, is_of_latents, part->first, part->last, part->snapshots, part->rows});
    }
    return {entity, std::move(some),
            is_recorded ? journal_snapshots(entity) : std::vector<SnapshotEntry>(),
            [this](uint32_t number) { return segment(number); }};
  }

  Result<uint64_t> count(const MemoryId& entity, bool is_latent) {
    return make_timeline(entity, !is_latent, is_latent).count();
  }
};

StoreReader::StoreReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
StoreReader::~StoreReader() = default;

Result<std::unique_ptr<StoreReader>> StoreReader::open(const std::filesystem::path& store) {
  Status last;
  for (int attempt = 0; attempt < kOpenAttempts; ++attempt) {
    auto state = std::make_unique<State>();
    state->path = store;
    last = state->load();
    if (!last.ok())
      if (const auto manifest = read_manifest(store); !manifest.ok()) return manifest.status();
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t now, read_generation(store));
    // The journals may belong to another generation and may have been missing or partly removed.
    if (now != state->manifest.generation) continue;
    if (!last.ok()) return last;
    return std::unique_ptr<StoreReader>(new StoreReader(std::move(state)));
  }
  return unavailable("store '{}': changed {} times while it was being opened", store.string(),
                     kOpenAttempts);
}

const std::filesystem::path& StoreReader::path() const {
  return state_->path;
}
const Manifest& StoreReader::manifest() const {
  return state_->manifest;
}
uint64_t StoreReader::damaged_places() const {
  return state_->manifest.damaged + state_->journal_damaged;
}

std::vector<MemoryId> StoreReader::entities() const {
  std::vector<MemoryId> ids;
  const auto& stored = state_->stored.all();
  for (const auto& [id, known] : stored) ids.push_back(id);
  for (const auto& [id, frames] : state_->journal_entries)
    if (!stored.contains(id)) ids.push_back(id);
  std::ranges::sort(ids);
  return ids;
}

std::map<MemoryId, std::optional<Time>> StoreReader::journal_times() const {
  std::map<MemoryId, std::optional<Time>> last;
  for (const auto& [entity, frames] : state_->journal_entries) {
    std::optional<Time>& of_entity = last[entity];
    for (const JournalEntry& frame : frames)
      of_entity = std::max(of_entity.value_or(frame.head.time), frame.head.time);
  }
  return last;
}

bool StoreReader::has(const MemoryId& entity) const {
  return state_->has(entity);
}

Result<EntitySummary> StoreReader::summary(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(Timeline * moments, timeline(entity));
  EntitySummary summary;
  summary.id = entity;
  ENGRAM_ASSIGN_OR_RETURN(summary.snapshots, moments->count());
  ENGRAM_ASSIGN_OR_RETURN(summary.recorded_snapshots, state_->count(entity, false));
  ENGRAM_ASSIGN_OR_RETURN(summary.latent_snapshots, state_->count(entity, true));
  summary.first = moments->first().value_or(Time{});
  summary.last = moments->last().value_or(Time{});
  for (const auto& [segment, part] : state_->stored.of(entity)) {
    const bool is_latent = state_->manifest.segments[segment].kind == SegmentKind::kLatent;
    (is_latent ? summary.latent_bytes : summary.stored_bytes) += part->stored_bytes;
    summary.raw_bytes += part->raw_bytes;
    summary.augmented_snapshots += part->augmented;
    summary.offered += part->dropped;
    summary.offered_bytes += part->dropped_bytes;
    summary.latent.model_version =
        std::max(summary.latent.model_version, part->latent.model_version);
    summary.latent.image_rows += part->latent.image_rows;
    summary.latent.psnr_db += part->latent.psnr_db;
    summary.latent.image_mse += part->latent.image_mse;
    summary.latent.number_rows += part->latent.number_rows;
    summary.latent.number_mse += part->latent.number_mse;
  }
  if (const auto frames = state_->journal_entries.find(entity);
      frames != state_->journal_entries.end()) {
    for (const JournalEntry& entry : frames->second) {
      summary.raw_bytes += entry.head.raw_bytes;
      summary.augmented_snapshots += entry.head.is_augmented ? 1 : 0;
      summary.offered += entry.head.dropped;
      summary.offered_bytes += entry.head.dropped_bytes;
      summary.stored_bytes += entry.frame_bytes;
    }
  }
  if (const auto trailing = state_->journal_trailing.find(entity);
      trailing != state_->journal_trailing.end()) {
    summary.offered += trailing->second.first;
    summary.offered_bytes += trailing->second.second;
  }
  if (const auto gone = state_->manifest.forgotten.find(entity);
      gone != state_->manifest.forgotten.end()) {
    summary.forgotten = gone->second;
    summary.offered += gone->second.snapshots + gone->second.dropped;
    summary.offered_bytes += gone->second.raw_bytes + gone->second.dropped_bytes;
  }
  if (const auto reasons = state_->manifest.dropped_by.find(entity);
      reasons != state_->manifest.dropped_by.end())
    summary.dropped_by = reasons->second;
  summary.offered += summary.snapshots;
  summary.offered_bytes += summary.raw_bytes;
  const auto models = state_->models.find(entity);
  if (models == state_->models.end()) return summary;
  for (const ModelInfo* model : models->second) {
    summary.models.push_back(*model);
    summary.model_bytes += model->bytes;
  }
  return summary;
}

Result<Timeline*> StoreReader::timeline(const MemoryId& entity) {
  if (const auto known = state_->timelines.find(entity); known != state_->timelines.end())
    return &known->second;
  if (!state_->has(entity)) return state_->no_such_entity(entity, entities());
  return &state_->timelines.emplace(entity, state_->make_timeline(entity, true, true))
              .first->second;
}

Result<EntityTimes> StoreReader::times(const MemoryId& entity) {
  if (!state_->has(entity)) return state_->no_such_entity(entity, entities());
  EntityTimes times;
  for (const auto& [number, part] : state_->stored.of(entity)) {
    if (part->snapshots == 0) continue;
    ENGRAM_ASSIGN_OR_RETURN(SegmentReader * segment, state_->segment(number));
    ENGRAM_ASSIGN_OR_RETURN(const auto spans, segment->index(entity));
    std::vector<Time> some(spans.size());
    std::ranges::transform(spans, some.begin(), &RowSpan::time);
    times.add(some, state_->manifest.segments[number].kind == SegmentKind::kLatent,
              part->augmented == part->snapshots);
  }
  const std::vector<SnapshotEntry> unsealed = this->unsealed(entity);
  std::vector<Time> some(unsealed.size());
  std::ranges::transform(unsealed, some.begin(), &SnapshotEntry::time);
  times.add(some, false, false);
  return times;
}

Result<const std::vector<SnapshotEntry>*> StoreReader::index(const MemoryId& entity) {
  if (const auto known = state_->indices.find(entity); known != state_->indices.end())
    return &known->second;
  if (!state_->has(entity)) return state_->no_such_entity(entity, entities());
  ENGRAM_ASSIGN_OR_RETURN(Timeline * moments, timeline(entity));
  std::vector<SnapshotEntry> entries;
  ENGRAM_RETURN_IF_ERROR(moments->for_each([&entries](const SnapshotEntry& entry) {
    entries.push_back(entry);
    return Status();
  }));
  return &state_->indices.emplace(entity, std::move(entries)).first->second;
}

std::vector<SnapshotEntry> StoreReader::unsealed(const MemoryId& entity) const {
  return state_->journal_snapshots(entity);
}

uint64_t StoreReader::journal_number(const SnapshotEntry::Location& in_journal) const {
  ENGRAM_CHECK(in_journal.rows == 0 && in_journal.source < state_->journal_numbers.size(),
               "there is no journal {}", in_journal.source);
  return state_->journal_numbers[in_journal.source];
}

Result<PackedSnapshot> StoreReader::read_packed(const MemoryId& entity,
                                                const SnapshotEntry& entry) {
  ENGRAM_CHECK(entry.recorded.has_value(), "'{}' has no recorded form",
               entity.at(entry.time).to_string());
  const SnapshotEntry::Location& at = *entry.recorded;
  if (at.rows == 0) {
    ENGRAM_ASSIGN_OR_RETURN(const Buffer payload,
                            read_journal_frame(state_->journals[at.source], at.at));
    return decode_frame(payload);
  }
  ENGRAM_ASSIGN_OR_RETURN(SegmentReader * segment, state_->segment(at.source));
  return segment->read_recorded(entity, {entry.time, at.at, at.rows});
}

Result<PackedSnapshot> StoreReader::read_values(const MemoryId& entity,
                                                const SnapshotEntry& entry) {
  ENGRAM_CHECK(entry.recorded.has_value(), "'{}' has no recorded form",
               entity.at(entry.time).to_string());
  const SnapshotEntry::Location& at = *entry.recorded;
  if (at.rows == 0) return read_packed(entity, entry);
  ENGRAM_ASSIGN_OR_RETURN(SegmentReader * segment, state_->segment(at.source));
  return segment->read_values(entity, {entry.time, at.at, at.rows});
}

Result<std::vector<ArrivedSnapshot>> StoreReader::arrivals(const MemoryId& entity) {
  if (!state_->has(entity)) return state_->no_such_entity(entity, entities());
  std::vector<ArrivedSnapshot> all;
  for (const auto& [number, part] : state_->stored.of(entity)) {
    if (part->snapshots == 0) continue;
    ENGRAM_ASSIGN_OR_RETURN(SegmentReader * segment, state_->segment(number));
    ENGRAM_ASSIGN_OR_RETURN(const auto some, segment->arrivals(entity));
    all.insert(all.end(), some.begin(), some.end());
  }
  for (const SnapshotEntry& entry : state_->journal_snapshots(entity)) {
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, read_packed(entity, entry));
    Time latest{};
    for (const PackedInstance& instance : packed.instances)
      latest = std::max(latest, instance.metadata.arrived);
    all.push_back({entry.time, latest == Time{} ? entry.time : latest});
  }
  // Later places are newer, and a stable sort leaves them behind.
  std::ranges::stable_sort(all, {}, &ArrivedSnapshot::time);
  std::vector<ArrivedSnapshot> newest;
  newest.reserve(all.size());
  for (const ArrivedSnapshot& one : all) {
    if (!newest.empty() && newest.back().time == one.time)
      newest.back() = one;
    else
      newest.push_back(one);
  }
  return newest;
}

Result<bool> StoreReader::arrived_in_time(const MemoryId& entity) {
  if (state_->journal_entries.contains(entity)) return false;
  for (const auto& [number, part] : state_->stored.of(entity)) {
    if (part->snapshots == 0) continue;
    ENGRAM_ASSIGN_OR_RETURN(SegmentReader * segment, state_->segment(number));
    ENGRAM_ASSIGN_OR_RETURN(const bool tells, segment->has_arrivals(entity));
    if (tells) return false;
  }
  return true;
}

Result<StoredForms> StoreReader::forms(const MemoryId& entity, uint32_t segment) {
  ENGRAM_CHECK(segment < state_->manifest.segments.size(), "there is no segment {}", segment);
  ENGRAM_ASSIGN_OR_RETURN(SegmentReader * reader, state_->segment(segment));
  return reader->forms(entity);
}

Result<StoredForms> StoreReader::newest_forms(const MemoryId& entity) {
  StoredForms all;
  int looked_at = 0;
  const EntityIndex::Entries& entries = state_->stored.of(entity);
  for (auto entry = entries.rbegin(); entry != entries.rend() && looked_at < kSegmentsForForms;
       ++entry) {
    const auto& [segment, part] = *entry;
    if (state_->manifest.segments[segment].kind != SegmentKind::kRecorded || part->snapshots == 0)
      continue;
    ++looked_at;
    ENGRAM_ASSIGN_OR_RETURN(const StoredForms found, forms(entity, segment));
    all.add(found);
  }
  return all;
}

Result<Snapshot> StoreReader::read_recorded(const MemoryId& entity, const SnapshotEntry& entry) {
  ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, read_packed(entity, entry));
  return unpack(packed, state_->decoder);
}

Result<bool> StoreReader::is_augmented(const MemoryId& entity, const SnapshotEntry& entry) {
  const SnapshotEntry::Location& at = *entry.recorded;
  if (at.rows > 0) {
    // The manifest counts augmented snapshots per segment. Usually none or all are, so the row need
    // not be read.
    const SegmentEntity* part = state_->manifest.segments[at.source].find(entity);
    if (part == nullptr || part->augmented == 0) return false;
    if (part->augmented == part->snapshots) return true;
  }
  ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, read_packed(entity, entry));
  return packed.is_augmented();
}

Result<std::vector<LatentQuality>> StoreReader::read_qualities(const MemoryId& entity,
                                                               const SnapshotEntry& entry) {
  ENGRAM_CHECK(entry.latent.has_value(), "'{}' has no latents", entity.at(entry.time).to_string());
  ENGRAM_ASSIGN_OR_RETURN(SegmentReader * segment, state_->segment(entry.latent->source));
  return segment->read_qualities(entity, {entry.time, entry.latent->at, entry.latent->rows});
}

Result<LatentSnapshot> StoreReader::read_latent(const MemoryId& entity,
                                                const SnapshotEntry& entry) {
  ENGRAM_CHECK(entry.latent.has_value(), "'{}' has no latents", entity.at(entry.time).to_string());
  ENGRAM_ASSIGN_OR_RETURN(SegmentReader * segment, state_->segment(entry.latent->source));
  return segment->read_latent(entity, {entry.time, entry.latent->at, entry.latent->rows});
}

}  // namespace engram::ltm
