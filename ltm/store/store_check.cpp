// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_check.h"

#include <algorithm>
#include <set>

#include "ltm/store/frame.h"
#include "ltm/store/journal.h"
#include "ltm/store/orphans.h"
#include "ltm/store/segment_check.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

/// Max attempts to list the store. A writer may seal a journal or replace a segment meanwhile.
constexpr int kCheckAttempts = 100;
/// Max number of damaged frames reported one by one per journal.
constexpr uint64_t kMaxTold = 10;

/// True if a directory without a manifest still has data of a store.
bool has_data(const std::filesystem::path& store) {
  std::error_code error;
  for (const char* folder : {"segments", "models", "journal"})
    for (const auto& entry : std::filesystem::directory_iterator(store / folder, error))
      if (entry.is_regular_file(error)) return true;
  return false;
}

uint64_t size_of(const std::filesystem::path& file) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(file, error);
  return error ? 0 : size;
}

class StoreCheck {
 public:
  StoreCheck(const std::filesystem::path& store, const CheckOptions& options,
             const ProgressSink& progress, const std::stop_token& stop)
      : store_(store), options_(options), progress_(progress), stop_(stop) {}

  Result<CheckReport> run() {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_readable, load());
    if (!is_readable) return std::move(report_);
    report_.generation = manifest_.generation;
    check_manifest();
    for (const SegmentInfo& segment : manifest_.segments)
      for (const SegmentEntity& entity : segment.entities) links_.add_entity(entity.id);
    for (const SegmentInfo& segment : manifest_.segments) ENGRAM_RETURN_IF_ERROR(check(segment));
    for (const ModelInfo& model : manifest_.models) ENGRAM_RETURN_IF_ERROR(check(model));
    for (const uint64_t number : journals_) ENGRAM_RETURN_IF_ERROR(check_journal(number));
    ENGRAM_RETURN_IF_ERROR(find_missing_journals());
    std::ranges::move(check_indexes(store_, manifest_), std::back_inserter(report_.findings));
    ENGRAM_RETURN_IF_ERROR(add_orphans());
    std::ranges::move(links_.findings(), std::back_inserter(report_.findings));
    report_.entities = links_.entities().size();
    return std::move(report_);
  }

 private:
  void add_fault(const std::string& file, std::string object, std::string what) {
    report_.findings.push_back(fault(file, std::move(object), std::move(what)));
  }
  void add_note(const std::string& file, std::string what, std::string advice) {
    report_.findings.push_back({Severity::kNote, file, "", std::move(what), std::move(advice)});
  }

  /// Reads the manifest and lists the journals of one generation. Returns false if the manifest is
  /// damaged or missing.
  Result<bool> load() {
    for (int attempt = 0; attempt < kCheckAttempts; ++attempt) {
      auto manifest = read_manifest(store_);
      if (manifest.status().code() == StatusCode::kDataLoss ||
          (manifest.status().code() == StatusCode::kNotFound && has_data(store_))) {
        add_fault("MANIFEST.json", "", manifest.status().message());
        return false;
      }
      if (!manifest.ok()) return manifest.status();
      ENGRAM_ASSIGN_OR_RETURN(journals_, list_journals(store_));
      const auto now = read_manifest(store_);
      if (!now.ok() || now->generation != manifest->generation) continue;
      manifest_ = std::move(manifest).value();
      std::erase_if(journals_, [&](uint64_t n) { return n < manifest_.first_journal; });
      sum_up();
      return true;
    }
    return unavailable("store '{}': changed {} times while it was being opened", store_.string(),
                       kCheckAttempts);
  }

  void sum_up() {
    for (const SegmentInfo& segment : manifest_.segments) total_ += segment.bytes;
    for (const ModelInfo& model : manifest_.models) total_ += model.bytes;
    for (const uint64_t number : journals_) total_ += size_of(store_ / Journal::file_name(number));
  }

  Status begin(const std::string& file) {
    if (stop_.stop_requested()) return cancelled("check of '{}': stopped", store_.string());
    if (progress_) progress_({"check", done_, total_, file, -1});
    return {};
  }

  Status add_orphans() {
    ENGRAM_ASSIGN_OR_RETURN(auto orphans, find_orphans(store_));
    std::ranges::move(orphans, std::back_inserter(report_.findings));
    return {};
  }

  void check_manifest() {
    std::set<std::string> files;
    for (const SegmentInfo& segment : manifest_.segments) {
      if (!files.insert(segment.file).second)
        add_fault("MANIFEST.json", segment.file, "is named more than once");
      if (segment_number(segment.file) >= manifest_.next_segment)
        add_fault("MANIFEST.json", segment.file,
                  fmt::format("the next segment, number {}, would take its place",
                              manifest_.next_segment));
      check_entities(segment);
    }
    for (const ModelInfo& model : manifest_.models)
      if (!files.insert(model.file).second)
        add_fault("MANIFEST.json", model.file, "is named more than once");
    if (manifest_.damaged > 0)
      add_note("MANIFEST.json",
               fmt::format("{} places in journals were found damaged before; what was there is "
                           "lost",
                           manifest_.damaged),
               "look at journal/*.damaged, where they are still there");
  }

  void check_entities(const SegmentInfo& segment) {
    if (const Status packed = segment.entities.verify(); !packed.ok())
      return add_fault("MANIFEST.json", segment.file, packed.message());
    std::set<MemoryId> seen;
    uint64_t bytes = 0;
    for (const SegmentEntity& entity : segment.entities) {
      const std::string object = segment.file + ": " + entity.id.to_string();
      if (!seen.insert(entity.id).second)
        add_fault("MANIFEST.json", object, "is named more than once");
      if (entity.snapshots > entity.rows || entity.first > entity.last)
        add_fault("MANIFEST.json", object, "its counts or times contradict each other");
      bytes += entity.stored_bytes;
    }
    if (!segment.entities.empty() && bytes != segment.bytes)
      add_fault("MANIFEST.json", segment.file,
                fmt::format("the shares of its entities sum to {} bytes, it has {}", bytes,
                            segment.bytes));
  }

  Status check(const SegmentInfo& segment) {
    ENGRAM_RETURN_IF_ERROR(begin(segment.file));
    const size_t before = report_.findings.size();
    ENGRAM_RETURN_IF_ERROR(
        check_segment(store_, manifest_, segment, options_, stop_, report_, links_));
    forget_if_replaced(before, segment.file);
    done_ += segment.bytes;
    return {};
  }

  Status check(const ModelInfo& model) {
    ENGRAM_RETURN_IF_ERROR(begin(model.file));
    const size_t before = report_.findings.size();
    ++report_.models;
    report_.bytes += model.bytes;
    auto findings = check_file(store_, model.file, model.bytes, model.checksum);
    const Status tested = findings.empty() && options_.test_model
                              ? options_.test_model(store_ / model.file)
                              : Status();
    if (!tested.ok()) findings.push_back(fault(model.file, model.name(), tested.message()));
    for (Finding& finding : findings) {
      finding.object = model.name();
      report_.findings.push_back(std::move(finding));
    }
    forget_if_replaced(before, model.file);
    done_ += model.bytes;
    return {};
  }

  /// Removes the findings about a file that a newer generation no longer names, because it may have
  /// been removed during the check.
  void forget_if_replaced(size_t before, const std::string& file) {
    if (report_.findings.size() == before) return;
    const auto now = read_manifest(store_);
    if (!now.ok() || now->generation == manifest_.generation) return;
    const bool is_named =
        std::ranges::find(now->segments, file, &SegmentInfo::file) != now->segments.end() ||
        std::ranges::find(now->models, file, &ModelInfo::file) != now->models.end();
    if (!is_named) report_.findings.resize(before);
  }

  Status check_journal(uint64_t number) {
    const std::string file = Journal::file_name(number).string();
    ENGRAM_RETURN_IF_ERROR(begin(file));
    uint64_t undecodable = 0;
    const auto scan =
        scan_journal(store_ / file, [&](uint64_t offset, const Buffer& payload) -> Status {
          if (stop_.stop_requested()) return cancelled("check of '{}': stopped", store_.string());
          const Status status = check_frame(file, payload);
          if (!status.ok() && undecodable++ < kMaxTold)
            add_fault(file, fmt::format("frame at byte {}", offset), status.message());
          return {};
        });
    if (scan.status().code() == StatusCode::kCancelled) return scan.status();
    if (is_sealed_meanwhile(number)) return {};
    ++report_.journals;
    report_.bytes += size_of(store_ / file);
    done_ += size_of(store_ / file);
    if (scan.ok())
      tell(file, *scan);
    else
      add_fault(file, "", scan.status().message());
    return {};
  }

  Status check_frame(const std::string& file, const Buffer& payload) {
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, decode_frame(payload));
    if (!packed.instances.empty()) links_.add_entity(packed.entity);
    links_.add(packed, manifest_.types, file);
    return options_.is_deep ? unpack(packed).status() : Status();
  }

  void tell(const std::string& file, const JournalScan& scan) {
    report_.frames += scan.frames;
    const uint64_t places = scan.damaged - (scan.missing_bytes > 0 ? 1 : 0);
    if (places > 0)
      add_fault(file, "",
                fmt::format("{} places are damaged; acknowledged data was there", places));
    if (scan.missing_bytes > 0) {
      add_fault(
          file, "",
          fmt::format("is whole up to byte {}, but {} bytes were forced to the disk: the last "
                      "{} are lost",
                      *scan.acknowledged_bytes - scan.missing_bytes, *scan.acknowledged_bytes,
                      scan.missing_bytes));
      return;
    }
    if (scan.torn_may_be_damage)
      add_fault(file, "last frame",
                "fails its checksum: damage, or a torn append that a power cut left");
    else if (scan.torn_bytes > 0)
      tell_torn(file, scan);
  }

  void tell_torn(const std::string& file, const JournalScan& scan) {
    const std::string what =
        fmt::format("ends in {} bytes that are no whole frame", scan.torn_bytes);
    if (scan.acknowledged_bytes) {
      add_note(file,
               fmt::format("{}: an append that was cut off. All {} bytes that were forced to the "
                           "disk are whole",
                           what, *scan.acknowledged_bytes),
               "nothing");
      return;
    }
    ++report_.unknown_ends;
    add_note(file,
             what +
                 ": an append that was cut off, or a file that was. Nobody noted how much of it "
                 "was acknowledged",
             "nothing, if the process that wrote it was killed or lost its power");
  }

  Status find_missing_journals() {
    ENGRAM_ASSIGN_OR_RETURN(const auto marks, list_acknowledged_marks(store_));
    for (const uint64_t number : marks) {
      const std::filesystem::path file = Journal::file_name(number);
      const auto forced = acknowledged_bytes(store_ / file);
      const auto now = read_manifest(store_);
      // A writer beside this may seal a journal at any moment, and removes the note first.
      if (!forced || !now.ok() || number < now->first_journal ||
          std::filesystem::exists(store_ / file))
        continue;
      add_fault(file.string(), "",
                fmt::format("is missing; {} bytes of it were forced to the disk", *forced));
    }
    return {};
  }

  [[nodiscard]] bool is_sealed_meanwhile(uint64_t number) const {
    std::error_code error;
    const auto now = read_manifest(store_);
    return (now.ok() && number < now->first_journal) ||
           !std::filesystem::exists(store_ / Journal::file_name(number), error);
  }

  const std::filesystem::path& store_;
  const CheckOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  Manifest manifest_;
  std::vector<uint64_t> journals_;
  LinkCheck links_;
  uint64_t done_ = 0;
  uint64_t total_ = 0;
  CheckReport report_;
};

}  // namespace

uint64_t CheckReport::faults() const {
  return static_cast<uint64_t>(std::ranges::count(findings, Severity::kFault, &Finding::severity));
}

Result<CheckReport> check_store(const std::filesystem::path& store, const CheckOptions& options,
                                const ProgressSink& progress, const std::stop_token& stop) {
  return StoreCheck(store, options, progress, stop).run();
}

}  // namespace engram::ltm
