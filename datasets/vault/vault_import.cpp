// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_import.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "datasets/vault/day_records.h"
#include "datasets/vault/work_progress.h"
#include "ltm/core/printable.h"
#include "ltm/store/publish_recorded.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"

namespace engram::datasets::vault {

namespace {

/// What is published as one segment. A segment is written without a break, and Ctrl-C must not wait
/// long for it.
constexpr uint64_t kBatchBytes = uint64_t{24} << 20;
constexpr uint64_t kBatchSnapshots = 20'000;
/// A group of images that has begun may exceed that so far.
constexpr uint64_t kMaxBatchBytes = 4 * kBatchBytes;

/// The snapshots of the next segment, and what a report says of them once they are in.
class ImportBatch {
 public:
  void add(VaultSnapshot snapshot, const ColumnPaths& columns) {
    ltm::PackedSnapshot& packed = snapshot.packed;
    ends_groups_ = true;
    for (const ltm::PackedInstance& instance : packed.instances)
      for (const ltm::PackedMedium& medium : instance.value.media) {
        if (groups_.insert(medium.bytes.data()).second) bytes_ += medium.bytes.size();
        if (medium.group && medium.group->index + 1 < medium.group->count) ends_groups_ = false;
      }
    bytes_ += bytes_without_media(packed);
    ++counts_.snapshots;
    counts_.instances += packed.instances.size();
    counts_.reconstructed += snapshot.reconstructed.is<idf::None>() ? 0 : 1;
    counts_.first = std::min(counts_.first.value_or(packed.time), packed.time);
    counts_.last = std::max(counts_.last.value_or(packed.time), packed.time);
    auto& entity = entities_[packed.entity];
    columns_[packed.entity].insert(columns.begin(), columns.end());
    entity.snapshots.push_back(std::move(packed));
  }

  [[nodiscard]] bool is_full() const {
    if (bytes_ >= kMaxBatchBytes) return true;
    return ends_groups_ && (bytes_ >= kBatchBytes || counts_.snapshots >= kBatchSnapshots);
  }

  /// Whether it is published in a moment.
  [[nodiscard]] bool is_small() const { return bytes_ <= kBatchBytes; }

  /// Adds what came in to a report.
  Status publish(const std::filesystem::path& store, const ltm::SegmentTypes& types,
                 VaultImportReport& report) {
    if (entities_.empty()) return {};
    for (auto& [id, entity] : entities_)
      entity.rules = ltm::SealRules::columns(std::move(columns_[id]));
    ENGRAM_RETURN_IF_ERROR(ltm::publish_recorded(store, entities_, types));
    report.snapshots += counts_.snapshots;
    report.instances += counts_.instances;
    report.reconstructed += counts_.reconstructed;
    report.first = std::min(report.first.value_or(*counts_.first), *counts_.first);
    report.last = std::max(report.last.value_or(*counts_.last), *counts_.last);
    *this = {};
    return {};
  }

 private:
  std::map<ltm::MemoryId, ltm::RecordedEntity> entities_;
  std::map<ltm::MemoryId, ColumnPaths> columns_;
  std::set<const std::byte*> groups_;
  uint64_t bytes_ = 0;
  VaultImportReport counts_;
  bool ends_groups_ = true;
};

/// One import: day by day, in batches that are published as they fill.
class VaultImport {
 public:
  VaultImport(const VaultPlaces& places, std::filesystem::path store, const VaultKeys& keys,
              const ProgressSink& progress, const std::stop_token& stop)
      : vault_(places.vault),
        store_(std::move(store)),
        keys_(keys),
        stop_(stop),
        progress_("import vault", progress) {}

  Result<VaultImportReport> run() {
    report_.destroyed = keys_.destroyed_count();
    ENGRAM_RETURN_IF_ERROR(open_store());
    progress_.begin(total());
    for (const auto& [entity, days] : keys_.days)
      for (const auto& [day, kept] : days) {
        ENGRAM_RETURN_IF_ERROR(take(entity, day, kept));
        if (!report_.is_cancelled) continue;
        // The next import reads again what would let Ctrl-C wait.
        if (batch_.is_small()) ENGRAM_RETURN_IF_ERROR(publish());
        return std::move(report_);
      }
    ENGRAM_RETURN_IF_ERROR(publish());
    progress_.end();
    return std::move(report_);
  }

 private:
  Status open_store() {
    if (ltm::is_store_absent(store_)) ENGRAM_RETURN_IF_ERROR(ltm::create_store(store_));
    ENGRAM_ASSIGN_OR_RETURN(writer_, ltm::StoreWriter::open(store_, {}));
    ENGRAM_RETURN_IF_ERROR(writer_->seal());
    ENGRAM_RETURN_IF_ERROR(check_types());
    for (const auto& [segment, type] : keys_.types.all())
      if (writer_->types().find(segment) == nullptr)
        ENGRAM_RETURN_IF_ERROR(writer_->declare(segment, type));
    ENGRAM_ASSIGN_OR_RETURN(before_, ltm::StoreReader::open(store_));
    return {};
  }

  /// Of all segments before any is declared: a store that does not fit stays as it is.
  Status check_types() {
    for (const auto& [segment, type] : keys_.types.all()) {
      const idf::Type* known = writer_->types().find(segment);
      if (known != nullptr && !(*known == type))
        return failed_precondition(
            "store '{}': segment '{}' has another type than in the vault; needs a new store",
            printable(store_.string()), segment.printable());
    }
    return {};
  }

  [[nodiscard]] uint64_t total() const {
    uint64_t snapshots = 0;
    for (const auto& [entity, days] : keys_.days)
      for (const auto& [day, kept] : days) snapshots += kept.snapshots;
    return snapshots;
  }

  Status take(const ltm::MemoryId& entity, Day day, const VaultDay& kept) {
    ++report_.days;
    auto reader = DayReader::open(day_file(vault_, kept.file), entity, day, kept);
    if (!reader.ok()) return note_damage(entity, day, kept, reader.status());
    const std::string name = printable_day(entity, day);
    while (true) {
      if (stop_.stop_requested()) {
        report_.is_cancelled = true;
        return {};
      }
      auto snapshot = reader->next();
      if (!snapshot.ok()) return note_damage(entity, day, kept, snapshot.status());
      if (!*snapshot) return {};
      progress_.add(1, name);
      ENGRAM_RETURN_IF_ERROR(take(**std::move(snapshot), reader->columns()));
    }
  }

  Status take(VaultSnapshot snapshot, const ColumnPaths& columns) {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_there, is_in_store(snapshot.packed));
    if (is_there) {
      ++report_.already_there;
      return {};
    }
    batch_.add(std::move(snapshot), columns);
    return batch_.is_full() ? publish() : Status();
  }

  /// The vault has each time of an entity once, so what came in meanwhile need not be looked at.
  Result<bool> is_in_store(const ltm::PackedSnapshot& packed) {
    if (!before_->has(packed.entity)) return false;
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, before_->timeline(packed.entity));
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(packed.time));
    return entry && entry->time == packed.time;
  }

  Status note_damage(const ltm::MemoryId& entity, Day day, const VaultDay& kept,
                     const Status& status) {
    report_.damaged.push_back({entity, day, to_text(kept.file), status.message()});
    return {};
  }

  Status publish() {
    const uint64_t needed = ltm::StoreWriter::Options().min_free_bytes;
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t free, free_disk_bytes(store_));
    if (free < needed)
      return resource_exhausted("store '{}': the disk has {} bytes left, importing needs {}",
                                printable(store_.string()), free, needed);
    return batch_.publish(store_, writer_->types(), report_);
  }

  std::filesystem::path vault_;
  std::filesystem::path store_;
  const VaultKeys& keys_;
  const std::stop_token& stop_;
  WorkProgress progress_;
  std::unique_ptr<ltm::StoreWriter> writer_;  ///< No other process writes meanwhile.
  std::unique_ptr<ltm::StoreReader> before_;  ///< The store as it was.
  ImportBatch batch_;
  VaultImportReport report_;
};

}  // namespace

Result<VaultImportReport> import_from_vault(const VaultPlaces& places,
                                            const std::filesystem::path& store,
                                            const ProgressSink& progress,
                                            const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const VaultKeys keys, read_keys_of(places));
  return VaultImport(places, store, keys, progress, stop).run();
}

}  // namespace engram::datasets::vault
