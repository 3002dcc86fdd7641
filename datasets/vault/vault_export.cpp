// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_export.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "datasets/recordings/merged_snapshots.h"
#include "datasets/vault/day_records.h"
#include "datasets/vault/store_days.h"
#include "datasets/vault/vault_mark.h"
#include "datasets/vault/work_progress.h"
#include "ltm/codec/packed_value.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "ltm/idf/binary.h"

namespace engram::datasets::vault {

namespace {

/// New files wait for a commit so long, until they have so many bytes, or are so many: each is lost
/// to a kill.
constexpr SteadyTime::duration kCommitInterval = std::chrono::seconds(1);
constexpr uint64_t kCommitBytes = uint64_t{256} << 20;
constexpr size_t kCommitFiles = 4096;
/// So much is forced to any disk in a moment.
constexpr uint64_t kQuickBytes = uint64_t{16} << 20;
/// A commit writes the key file as a whole. Where that takes long, so many times as long is worked
/// before the next one.
constexpr int kMinWorkPerCommit = 10;

/// The types of a store, and of segments that only the vault knows.
ltm::SegmentTypes united(const ltm::SegmentTypes& store, const ltm::SegmentTypes& vault) {
  ltm::SegmentTypes all = store;
  for (const auto& [segment, type] : vault.all())
    if (all.find(segment) == nullptr)
      if (const Status declared = all.declare(segment, type); !declared.ok())
        log::warning("vault: the type of '{}' is not kept: {}", segment.printable(),
                     declared.message());
  return all;
}

idf::Data error_data(const std::optional<ltm::MeasuredError>& error) {
  idf::Dict dict;
  if (error && !std::isnan(error->image_mse)) dict.set("image_mse", error->image_mse);
  if (error && !std::isnan(error->number_mse)) dict.set("number_mse", error->number_mse);
  return dict;
}

/// True if the vault has the same snapshots, and more of them as they were recorded: what a night
/// made of them in the store must not take their place. A redaction since then changes `times`.
bool is_better_than(const StoreDay& day, const VaultDay& kept) {
  return kept.times == day.times && kept.reconstructed < day.latents_only;
}

/// What becomes of a day of the store.
enum class DayPlan { kDestroyed, kAsBefore, kBetterInVault, kNew, kChanged };

/// A file that somebody removed or cut off is written again.
bool is_there(const std::filesystem::path& vault, const VaultDay& kept) {
  std::error_code error;
  return std::filesystem::file_size(day_file(vault, kept.file), error) == kept.file_bytes && !error;
}

DayPlan plan_of(const StoreDay& day, const VaultKeys& keys, const std::filesystem::path& vault) {
  if (keys.is_destroyed(day.entity, day.day)) return DayPlan::kDestroyed;
  const VaultDay* kept = keys.find(day.entity, day.day);
  if (kept == nullptr) return DayPlan::kNew;
  if (!is_there(vault, *kept)) return DayPlan::kChanged;
  if (is_better_than(day, *kept)) return DayPlan::kBetterInVault;
  const bool is_same = kept->source == day.source && kept->times == day.times;
  return is_same ? DayPlan::kAsBefore : DayPlan::kChanged;
}

/// Counts a day that is not written. Returns whether it is one.
bool count_idle(DayPlan plan, VaultExportReport& report) {
  report.destroyed += plan == DayPlan::kDestroyed ? 1 : 0;
  report.kept_recorded += plan == DayPlan::kBetterInVault ? 1 : 0;
  const bool is_unchanged = plan == DayPlan::kAsBefore || plan == DayPlan::kBetterInVault;
  report.unchanged += is_unchanged ? 1 : 0;
  return is_unchanged || plan == DayPlan::kDestroyed;
}

Status check_is_copy_of(const ltm::StoreReader& store, const VaultKeys& keys,
                        const VaultExportOptions& options) {
  const std::string& id = store.manifest().store_id;
  if (keys.store_id.empty() || keys.store_id == id || options.takes_other_store) return {};
  return failed_precondition(
      "store '{}': is {}, the vault is a copy of {}; needs that one, another vault, or --force to "
      "put both into one, where days of the same entity replace each other",
      printable(store.path().string()), id, keys.store_id);
}

/// Counts the days that the store has no more, of entities of which the query selects everything.
uint64_t count_vault_alone(const VaultKeys& keys, const std::vector<StoreDay>& days,
                           const ltm::Query& query) {
  std::set<EntityDay> in_store;
  for (const StoreDay& day : days) in_store.insert({day.entity, day.day});
  uint64_t count = 0;
  for (const auto& [entity, of_entity] : keys.days) {
    if (!selects_all(query, entity)) continue;
    for (const auto& [day, kept] : of_entity) count += in_store.contains({entity, day}) ? 0 : 1;
  }
  return count;
}

/// How values are packed that have no recorded form.
ltm::PackOptions lossless() {
  ltm::PackOptions options;
  options.image_codec = "rowpred";
  return options;
}

/// One export: each day that is new or changed into a file of its own.
class VaultExport {
 public:
  VaultExport(ltm::Recall& recall, const VaultExportOptions& options, const ProgressSink& progress,
              const std::stop_token& stop, VaultFolder folder, ltm::Packer packer)
      : recall_(recall),
        options_(options),
        stop_(stop),
        progress_("export vault", progress),
        folder_(std::move(folder)),
        packer_(std::move(packer)) {}

  Result<VaultExportReport> run(const std::vector<StoreDay>& days, const ltm::Query& query) {
    const ltm::Manifest& manifest = recall_.store().manifest();
    ENGRAM_RETURN_IF_ERROR(check_is_copy_of(recall_.store(), folder_.keys(), options_));
    folder_.describe(manifest.store_id, united(manifest.types, folder_.keys().types));
    report_.vault_alone = count_vault_alone(folder_.keys(), days, query);
    std::vector<const StoreDay*> work;
    for (const StoreDay& day : days)
      if (!count_idle(plan_of(day, folder_.keys(), folder_.vault()), report_)) work.push_back(&day);
    uint64_t total = 0;
    for (const StoreDay* day : work) total += day->snapshots;
    progress_.begin(total);
    last_commit_ = steady_now();
    for (const StoreDay* day : work) {
      if (const Status added = add(*day); !added.ok()) return end_early(added);
      if (is_commit_due()) ENGRAM_RETURN_IF_ERROR(commit());
    }
    ENGRAM_RETURN_IF_ERROR(commit());
    progress_.end();
    return std::move(report_);
  }

 private:
  Status add(const StoreDay& day) {
    VaultDay made;
    made.source = day.source;
    made.times = day.times;
    ENGRAM_RETURN_IF_ERROR(fill_random(made.file));
    ENGRAM_ASSIGN_OR_RETURN(made.key, SecretKey::random());
    unread_.reset();
    const Status status = write(day, made);
    const VaultDay* kept = folder_.keys().find(day.entity, day.day);
    if (!status.ok() ||
        (kept != nullptr && kept->digest == made.digest && is_there(folder_.vault(), *kept))) {
      ENGRAM_RETURN_IF_ERROR(remove_file(folder_.new_file(made.file)));
      if (status.ok()) {
        ++report_.unchanged;
        folder_.keep(day.entity, day.day, day.source, day.times);
        return {};
      }
      if (!unread_) return status;
      report_.unread.push_back({day.entity, day.day, "", unread_->to_string()});
      return {};
    }
    ++(kept == nullptr ? report_.added : report_.replaced);
    report_.snapshots += made.snapshots;
    report_.instances += made.instances;
    report_.reconstructed += made.reconstructed;
    report_.bytes += made.file_bytes;
    folder_.put(day.entity, day.day, made);
    return {};
  }

  Status write(const StoreDay& day, VaultDay& made) {
    ENGRAM_ASSIGN_OR_RETURN(
        SealedFileWriter file,
        SealedFileWriter::create(folder_.new_file(made.file), made.file, made.key));
    DayWriter writer(file);
    const auto columns = columns_of(day.entity);
    if (!columns.ok()) return note_unread(columns.status());
    ENGRAM_RETURN_IF_ERROR(writer.put_columns(*columns));
    const auto timeline = recall_.store().timeline(day.entity);
    if (!timeline.ok()) return note_unread(timeline.status());
    const std::string name = printable_day(day.entity, day.day);
    Status failed;
    const Status visited = (*timeline)->for_each(
        day_begin(day.day), day_end(day.day), [&](const ltm::SnapshotEntry& entry) -> Status {
          if (stop_.stop_requested()) return failed = cancelled("export was stopped");
          auto snapshot = read(day.entity, entry);
          if (!snapshot.ok()) return failed = note_unread(snapshot.status());
          progress_.add(1, name);
          return failed = writer.put(*std::move(snapshot));
        });
    ENGRAM_RETURN_IF_ERROR(failed);
    if (!visited.ok()) return note_unread(visited);
    return writer.finish(made);
  }

  /// What the store cannot read costs that day alone.
  Status note_unread(const Status& why) {
    unread_ = why;
    return why;
  }

  Result<VaultSnapshot> read(const ltm::MemoryId& entity, const ltm::SnapshotEntry& entry) {
    const bool prefers_latent = options_.recall.prefer == ltm::Prefer::kLatent;
    if (entry.recorded && !(prefers_latent && entry.latent)) {
      ENGRAM_ASSIGN_OR_RETURN(auto packed, recall_.store().read_packed(entity, entry));
      return VaultSnapshot{std::move(packed), {}};
    }
    ENGRAM_ASSIGN_OR_RETURN(
        const auto found, recalled_snapshot(recall_, entity, {entry, false, {}}, options_.recall));
    if (!found) return data_loss("'{}' is not there any more", entity.at(entry.time).printable());
    return packed_answer(entity, *found);
  }

  Result<VaultSnapshot> packed_answer(const ltm::MemoryId& entity,
                                      const ltm::SnapshotResult& found) {
    VaultSnapshot snapshot;
    snapshot.packed.entity = entity;
    snapshot.packed.time = found.time;
    idf::List errors;
    for (const ltm::InstanceResult& instance : found.instances) {
      ENGRAM_ASSIGN_OR_RETURN(auto value, packer_.pack(instance.data));
      snapshot.packed.raw_bytes += idf::encoded_size(instance.data);
      snapshot.packed.instances.push_back({std::move(value), instance.metadata});
      errors.push_back(error_data(instance.error));
    }
    snapshot.reconstructed = idf::Dict{{"model", found.model}, {"errors", std::move(errors)}};
    return snapshot;
  }

  Result<ColumnPaths> columns_of(const ltm::MemoryId& entity) {
    if (columns_entity_ == entity) return columns_;
    ENGRAM_ASSIGN_OR_RETURN(const ltm::StoredForms forms, recall_.store().newest_forms(entity));
    columns_ = forms.columns;
    columns_entity_ = entity;
    return columns_;
  }

  /// Keeps the days that are finished, unless that would let Ctrl-C wait.
  Status end_early(const Status& why) {
    const bool is_stopped = why.code() == StatusCode::kCancelled;
    if (is_stopped && folder_.waiting_bytes() > kQuickBytes) return why;
    if (const Status kept = commit(); !kept.ok())
      log::warning("vault: days that were finished are written again by the next export: {}",
                   kept.message());
    return why;
  }

  [[nodiscard]] bool is_commit_due() const {
    return folder_.waiting_bytes() >= kCommitBytes || folder_.waiting() >= kCommitFiles ||
           steady_now() - last_commit_ >=
               std::max(kCommitInterval, kMinWorkPerCommit * commit_took_);
  }

  Status commit() {
    const SteadyTime begin = steady_now();
    ENGRAM_RETURN_IF_ERROR(folder_.commit());
    last_commit_ = steady_now();
    commit_took_ = last_commit_ - begin;
    return {};
  }

  ltm::Recall& recall_;
  const VaultExportOptions& options_;
  const std::stop_token& stop_;
  WorkProgress progress_;
  VaultFolder folder_;
  ltm::Packer packer_;
  ltm::MemoryId columns_entity_;
  ColumnPaths columns_;
  std::optional<Status> unread_;
  SteadyTime last_commit_;
  SteadyTime::duration commit_took_{};
  VaultExportReport report_;
};

/// Changes nothing, not even the vault's directory.
Result<VaultExportReport> dry_run(const std::vector<StoreDay>& days, const ltm::Query& query,
                                  const ltm::StoreReader& store, const VaultPlaces& places,
                                  const VaultExportOptions& options) {
  VaultExportReport report;
  VaultKeys keys;
  std::error_code error;
  const bool has_vault = read_vault_id(places.vault).status().code() != StatusCode::kNotFound;
  if (has_vault || std::filesystem::exists(places.keys, error)) {
    ENGRAM_ASSIGN_OR_RETURN(keys, read_keys_of(places));
  }
  ENGRAM_RETURN_IF_ERROR(check_is_copy_of(store, keys, options));
  report.vault_alone = count_vault_alone(keys, days, query);
  for (const StoreDay& day : days) {
    const DayPlan plan = plan_of(day, keys, places.vault);
    if (count_idle(plan, report)) continue;
    ++(plan == DayPlan::kNew ? report.added : report.replaced);
    report.snapshots += day.snapshots;
  }
  return report;
}

}  // namespace

Result<VaultExportReport> export_to_vault(ltm::Recall& recall, const ltm::Query& query,
                                          const VaultPlaces& places,
                                          const VaultExportOptions& options,
                                          const ProgressSink& progress,
                                          const std::stop_token& stop) {
  if (options.is_dry) {
    ENGRAM_ASSIGN_OR_RETURN(const auto days,
                            days_of_store(recall, query, options.recall.prefer, stop));
    return dry_run(days, query, recall.store(), places, options);
  }
  // First what is wrong with the places, which takes no time.
  ENGRAM_ASSIGN_OR_RETURN(VaultFolder folder, VaultFolder::open(places));
  ENGRAM_ASSIGN_OR_RETURN(const auto days,
                          days_of_store(recall, query, options.recall.prefer, stop));
  ENGRAM_ASSIGN_OR_RETURN(ltm::Packer packer, ltm::Packer::create(lossless()));
  VaultExport run(recall, options, progress, stop, std::move(folder), std::move(packer));
  return run.run(days, query);
}

}  // namespace engram::datasets::vault
