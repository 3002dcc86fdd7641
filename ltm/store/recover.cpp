// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/recover.h"

#include <algorithm>
#include <set>

#include "ltm/core/file.h"
#include "ltm/store/checksum.h"
#include "ltm/store/journal.h"
#include "ltm/store/publish.h"
#include "ltm/store/rebuild.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/salvage.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_index.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"

namespace engram::ltm {

namespace {

bool is_there(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::exists(std::filesystem::symlink_status(path, error));
}

/// Copies a file and forces the copy to the disk.
Status copy_to_disk(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::copy_file(from, to, error);
  if (error == std::errc::no_space_on_device)
    return resource_exhausted("cannot copy '{}': {}", from.string(), error.message());
  if (error) return unavailable("cannot copy '{}': {}", from.string(), error.message());
  ENGRAM_ASSIGN_OR_RETURN(File copy, File::open(to, File::Mode::kRead));
  return copy.sync();
}

/// True if `path` is `directory` or lies below it.
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& directory) {
  std::error_code error;
  const auto inner = std::filesystem::weakly_canonical(path, error);
  const auto outer = std::filesystem::weakly_canonical(directory, error);
  const auto [end, other] = std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end());
  return end == outer.end();
}

class Recovery {
 public:
  Recovery(const std::filesystem::path& source, const std::filesystem::path& unfinished,
           const RecoverOptions& options, const ProgressSink& progress, const std::stop_token& stop)
      : source_(source), target_(unfinished), options_(options), progress_(progress), stop_(stop) {}

  Result<RecoverReport> run() {
    ENGRAM_RETURN_IF_ERROR(lock());
    ENGRAM_RETURN_IF_ERROR(load());
    ENGRAM_RETURN_IF_ERROR(create_store(target_));
    // Save models first, because latents are useless without their model.
    for (const ModelInfo& model : old_.models) ENGRAM_RETURN_IF_ERROR(save(model));
    for (const SegmentInfo& segment : old_.segments) ENGRAM_RETURN_IF_ERROR(save(segment));
    for (const uint64_t number : journals_) ENGRAM_RETURN_IF_ERROR(save_journal(number));
    ENGRAM_RETURN_IF_ERROR(find_missing_journals());
    ENGRAM_RETURN_IF_ERROR(check_unchanged());
    ENGRAM_RETURN_IF_ERROR(finish());
    if (options_.latest) ENGRAM_RETURN_IF_ERROR(leave_out_after(*options_.latest));
    return std::move(report_);
  }

 private:
  /// Takes the writer's lock so that no writer starts during recovery. Locking writes nothing to
  /// the source.
  Status lock() {
    auto file = File::open(source_ / kWriterLock, File::Mode::kRead);
    if (file.status().code() == StatusCode::kNotFound) return {};
    if (!file.ok()) return file.status();
    lock_ = std::move(file).value();
    ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, lock_->lock(false));
    if (is_locked) return {};
    return failed_precondition("store '{}': another process is writing to it: end that first",
                               source_.string());
  }

  Status load() {
    auto manifest = read_manifest(source_);
    if (manifest.ok())
      if (const Status packed = manifest->verify_entities(); !packed.ok()) manifest = packed;
    const StatusCode code = manifest.status().code();
    if (code == StatusCode::kDataLoss || (code == StatusCode::kNotFound && has_files())) {
      ENGRAM_RETURN_IF_ERROR(rebuild(manifest.status()));
    } else {
      ENGRAM_RETURN_IF_ERROR(manifest.status());
      old_ = std::move(manifest).value();
    }
    ENGRAM_ASSIGN_OR_RETURN(journals_, list_journals(source_));
    std::erase_if(journals_, [this](uint64_t n) { return n < old_.first_journal; });
    new_.store_id = old_.store_id;
    new_.generation = old_.generation;
    new_.next_segment = old_.next_segment;
    for (const SegmentInfo& segment : old_.segments)
      new_.next_segment = std::max(new_.next_segment, segment_number(segment.file) + 1);
    new_.first_journal = old_.first_journal;
    new_.damaged = old_.damaged;
    new_.types = old_.types;
    sum_up();
    return {};
  }

  [[nodiscard]] bool has_files() const {
    return is_there(source_ / "segments") || is_there(source_ / "journal");
  }

  Status rebuild(const Status& why) {
    if (progress_) progress_({"recover", 0, 0, "MANIFEST.json is rebuilt", -1});
    ENGRAM_ASSIGN_OR_RETURN(RebuiltManifest rebuilt, rebuild_manifest(source_));
    report_.is_rebuilt = true;
    report_.findings.push_back({Severity::kNote, "MANIFEST.json", "",
                                "is made anew from the files: " + why.message(),
                                "of snapshots that were updated, an older state may count again"});
    for (Finding& finding : rebuilt.findings) report_.findings.push_back(std::move(finding));
    report_.segments_lost += rebuilt.unreadable;
    old_ = std::move(rebuilt.manifest);
    damaged_.insert(rebuilt.damaged.begin(), rebuilt.damaged.end());
    return {};
  }

  void sum_up() {
    for (const ModelInfo& model : old_.models) total_ += model.bytes;
    for (const SegmentInfo& segment : old_.segments) total_ += segment.bytes;
  }

  Status begin(const std::string& file, uint64_t bytes) {
    if (stop_.stop_requested()) return cancelled("recover of '{}': stopped", source_.string());
    if (progress_) progress_({"recover", done_, total_, file, -1});
    done_ += bytes;
    return {};
  }

  void add_fault(const std::string& file, std::string object, std::string what,
                 std::string advice) {
    report_.findings.push_back(
        {Severity::kFault, file, std::move(object), std::move(what), std::move(advice)});
  }

  /// Copies a file if it matches the manifest. Returns false if it does not.
  Result<bool> copy(const std::string& file, uint64_t bytes, uint64_t expected) {
    std::error_code error;
    if (std::filesystem::file_size(source_ / file, error) != bytes || error) return false;
    ENGRAM_RETURN_IF_ERROR(make_directories((target_ / file).parent_path()));
    ENGRAM_RETURN_IF_ERROR(copy_to_disk(source_ / file, target_ / file));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t found, checksum_of_file(target_ / file));
    if (found == expected) return true;
    ENGRAM_RETURN_IF_ERROR(remove_file(target_ / file));
    return false;
  }

  Status save(const ModelInfo& model) {
    ENGRAM_RETURN_IF_ERROR(begin(model.file, model.bytes));
    ENGRAM_ASSIGN_OR_RETURN(const bool is_copied, copy(model.file, model.bytes, model.checksum));
    // Without a manifest the expected checksum is unknown.
    const bool needs_test = options_.test_model && (report_.is_rebuilt || !is_copied);
    const Status tested = needs_test ? options_.test_model(source_ / model.file) : Status();
    if (is_copied && tested.ok()) return keep(model);
    if (needs_test && tested.ok()) return keep_damaged(model);
    if (is_copied) ENGRAM_RETURN_IF_ERROR(remove_file(target_ / model.file));
    ++report_.models_lost;
    add_fault(
        model.file, model.name(),
        tested.ok() ? "is lost: it is not what the manifest says" : "is lost: " + tested.message(),
        "train another: what is recorded is enough for it");
    return {};
  }

  Status keep(const ModelInfo& model) {
    ++report_.models;
    new_.models.push_back(model);
    return {};
  }

  /// Keeps a model whose checksum does not match if it passes its test.
  Status keep_damaged(ModelInfo model) {
    ENGRAM_RETURN_IF_ERROR(make_directories((target_ / model.file).parent_path()));
    ENGRAM_RETURN_IF_ERROR(copy_to_disk(source_ / model.file, target_ / model.file));
    ENGRAM_ASSIGN_OR_RETURN(model.checksum, checksum_of_file(target_ / model.file));
    ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(target_ / model.file, File::Mode::kRead));
    ENGRAM_ASSIGN_OR_RETURN(model.bytes, file.size());
    report_.findings.push_back({Severity::kNote, model.file, model.name(),
                                "fails its checksum, but passes its own test", "nothing"});
    return keep(model);
  }

  [[nodiscard]] bool has_model(const SegmentEntity& entity) const {
    return std::ranges::any_of(new_.models, [&](const ModelInfo& model) {
      return model.entity == entity.id && model.version == entity.latent.model_version;
    });
  }

  Status save(const SegmentInfo& segment) {
    ENGRAM_RETURN_IF_ERROR(begin(segment.file, segment.bytes));
    if (segment.kind == SegmentKind::kLatent &&
        !std::ranges::all_of(segment.entities, [this](const auto& e) { return has_model(e); }))
      return lose_latents(segment);
    if (!damaged_.contains(segment.file)) {
      ENGRAM_ASSIGN_OR_RETURN(const bool is_copied,
                              copy(segment.file, segment.bytes, segment.checksum));
      if (is_copied) return keep(segment);
    }
    return salvage(segment);
  }

  Status keep(const SegmentInfo& segment) {
    ++report_.segments_copied;
    for (const SegmentEntity& entity : segment.entities)
      count(segment.kind, entity.id, entity.snapshots, 0);
    new_.segments.push_back(segment);
    return {};
  }

  Status lose_latents(const SegmentInfo& segment) {
    ++report_.segments_lost;
    for (const SegmentEntity& entity : segment.entities)
      count(segment.kind, entity.id, 0, entity.snapshots);
    add_fault(segment.file, "", "its latents are lost with the model that decodes them",
              "'engram consolidate' makes others of what is recorded");
    return {};
  }

  Status salvage(const SegmentInfo& segment) {
    ENGRAM_RETURN_IF_ERROR(make_directories(target_ / "segments"));
    const auto next_file = [this] { return fmt::format("segments/{:06}.h5", new_.next_segment++); };
    ENGRAM_ASSIGN_OR_RETURN(SalvagedSegment saved, salvage_segment(source_, segment, old_.types,
                                                                   target_, next_file, stop_));
    ++(saved.made.empty() ? report_.segments_lost : report_.segments_rewritten);
    for (const auto& [id, counts] : saved.entities)
      count(segment.kind, id, counts.saved, counts.lost);
    if (saved.findings.empty() && !report_.is_rebuilt)
      report_.findings.push_back({Severity::kNote, segment.file, "",
                                  "is damaged where no snapshot lies; all of them are saved",
                                  "nothing"});
    std::ranges::move(saved.made, std::back_inserter(new_.segments));
    std::ranges::move(saved.findings, std::back_inserter(report_.findings));
    return {};
  }

  void count(SegmentKind kind, const MemoryId& entity, uint64_t saved, uint64_t lost) {
    RecoveredEntity& counts = report_.entities[entity];
    (kind == SegmentKind::kLatent ? counts.latent : counts.recorded) += saved;
    (kind == SegmentKind::kLatent ? counts.latent_lost : counts.recorded_lost) += lost;
  }

  Status save_journal(uint64_t number) {
    const std::string file = Journal::file_name(number).string();
    ENGRAM_RETURN_IF_ERROR(begin(file, 0));
    ENGRAM_ASSIGN_OR_RETURN(const SalvagedJournal saved,
                            copy_journal(source_, target_, number, options_.latest));
    for (const auto& [id, snapshots] : saved.too_late) report_.entities[id].too_late += snapshots;
    for (const auto& [id, snapshots] : saved.snapshots) report_.entities[id].unsealed += snapshots;
    ++report_.journals;
    tell(file, saved.scan, saved.undecodable);
    return {};
  }

  Status find_missing_journals() {
    ENGRAM_ASSIGN_OR_RETURN(const auto marks, list_acknowledged_marks(source_));
    for (const uint64_t number : marks) {
      const auto forced = acknowledged_bytes(source_ / Journal::file_name(number));
      if (!forced || number < old_.first_journal ||
          std::ranges::find(journals_, number) != journals_.end())
        continue;
      ++report_.damaged_places;
      ++new_.damaged;
      add_fault(Journal::file_name(number).string(), "",
                fmt::format("is missing; {} bytes of it were forced to the disk", *forced),
                "none: nothing else holds it");
    }
    return {};
  }

  void tell(const std::string& file, const JournalScan& scan, uint64_t undecodable) {
    const uint64_t damaged = scan.damaged + undecodable + (scan.torn_may_be_damage ? 1 : 0);
    report_.damaged_places += damaged;
    new_.damaged += damaged;
    if (damaged > 0)
      add_fault(file, "", fmt::format("{} places are damaged; what was there is lost", damaged),
                "none: nothing else holds it");
    else if (scan.torn_bytes > 0)
      report_.findings.push_back(
          {Severity::kNote, file, "",
           fmt::format("its last {} bytes are no whole frame: an append that was cut off{}",
                       scan.torn_bytes, scan.acknowledged_bytes ? "" : ", or a file that was"),
           scan.acknowledged_bytes ? "nothing: all that was forced to the disk is whole"
                                   : "nothing, if the process that wrote it was killed"});
  }

  /// Checks that the source did not change. Consolidation does not take the writer's lock, so it
  /// may have run meanwhile.
  Status check_unchanged() const {
    if (report_.is_rebuilt) return {};
    const auto now = read_manifest(source_);
    if (now.ok() && now->generation == old_.generation) return {};
    return unavailable("store '{}': was changed while it was read: try again", source_.string());
  }

  Status finish() {
    ENGRAM_RETURN_IF_ERROR(edit_manifest(target_, [this](Manifest& manifest) -> Status {
      if (new_.store_id.empty()) new_.store_id = manifest.store_id;
      new_.generation = std::max(new_.generation, manifest.generation);
      manifest = new_;
      return {};
    }));
    for (const char* folder : {"segments", "models", "journal"})
      ENGRAM_RETURN_IF_ERROR(sync_directory(target_ / folder));
    return copy_indexes(source_, target_, new_);
  }

  /// Segments are copied first and then rewritten, as when something is forgotten.
  Status leave_out_after(Time latest) {
    ForgetSet gone;
    {
      ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(target_));
      for (const MemoryId& entity : reader->entities()) {
        ENGRAM_ASSIGN_OR_RETURN(const auto* entries, reader->index(entity));
        for (auto entry = entries->rbegin(); entry != entries->rend() && entry->time > latest;
             ++entry)
          gone[entity].insert(entry->time);
      }
    }
    if (gone.empty()) return {};
    for (const auto& [entity, times] : gone) report_.entities[entity].too_late += times.size();
    return forget_snapshots(target_, gone, progress_, stop_).status();
  }

  const std::filesystem::path& source_;
  const std::filesystem::path& target_;
  const RecoverOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::optional<File> lock_;
  Manifest old_;
  Manifest new_;
  /// Segments that were found damaged while the manifest was rebuilt.
  std::set<std::string> damaged_;
  std::vector<uint64_t> journals_;
  uint64_t done_ = 0;
  uint64_t total_ = 0;
  RecoverReport report_;
};

Status check_target(const std::filesystem::path& source, const std::filesystem::path& target,
                    const std::filesystem::path& unfinished) {
  if (lies_in(target, source))
    return invalid_argument("'{}': lies in the store that is to be recovered", target.string());
  if (is_there(target))
    return already_exists("'{}': is there already, cannot recover into it", target.string());
  if (is_there(unfinished))
    return already_exists("'{}': is what a recover that was killed left; remove it first",
                          unfinished.string());
  return {};
}

Status move_into_place(const std::filesystem::path& unfinished,
                       const std::filesystem::path& target) {
  std::error_code error;
  std::filesystem::rename(unfinished, target, error);
  if (error) return unavailable("cannot rename '{}': {}", unfinished.string(), error.message());
  return sync_directory(std::filesystem::absolute(target).parent_path());
}

}  // namespace

bool RecoverReport::has_loss() const {
  return std::ranges::any_of(findings,
                             [](const Finding& f) { return f.severity == Severity::kFault; });
}

Result<RecoverReport> recover_store(const std::filesystem::path& source,
                                    const std::filesystem::path& target,
                                    const RecoverOptions& options, const ProgressSink& progress,
                                    const std::stop_token& stop) {
  // "store/" and "store" are the same directory.
  const std::filesystem::path place = target.has_filename() ? target : target.parent_path();
  std::filesystem::path unfinished = place;
  unfinished += ".unfinished";
  ENGRAM_RETURN_IF_ERROR(check_target(source, place, unfinished));
  auto report = Recovery(source, unfinished, options, progress, stop).run();
  if (!report.ok()) {
    std::error_code ignored;
    std::filesystem::remove_all(unfinished, ignored);
    return report;
  }
  ENGRAM_RETURN_IF_ERROR(move_into_place(unfinished, place));
  return report;
}

}  // namespace engram::ltm
