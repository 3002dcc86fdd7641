// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/redact_store.h"

#include <nlohmann/json.hpp>

#include "ltm/forgetting/forget_plan.h"
#include "ltm/forgetting/pending_redaction.h"
#include "ltm/forgetting/plan_forgetting.h"
#include "ltm/forgetting/redacted_days.h"
#include "ltm/recall/recall.h"
#include "ltm/recall/store_past.h"
#include "ltm/store/night_lock.h"
#include "ltm/store/store_writer.h"
#include "ltm/store/superseded.h"

namespace engram::ltm {

namespace {

/// Redacted snapshots that are appended together. Unit: plain bytes.
constexpr uint64_t kMaxAppendedBytes = uint64_t{32} << 20;

/// How redacted images are recorded: without loss, but for those that lost something as JPEG
/// already.
Result<Packer> packer_like(StoreReader& reader, const MemoryId& entity) {
  PackOptions options;
  const auto forms = reader.newest_forms(entity);
  if (forms.ok() && forms->media_codecs.contains("jpeg")) options.image_codec = "jpeg:95";
  return Packer::create(options);
}

void add_all(ForgetSet& to, const ForgetSet& more) {
  for (const auto& [entity, times] : more) to[entity].insert_all(times);
}

/// Looks at snapshots, and records anew those in which something was found.
class SnapshotRedaction {
 public:
  /// `writer` is null if nothing is to be changed. All must outlive this.
  SnapshotRedaction(const StoreRedactionJob& job, Redactor& redactor, StoreWriter* writer,
                    StoreRedaction& report, ForgetSet& pending)
      : job_(job), redactor_(redactor), writer_(writer), report_(report), pending_(pending) {}

  Status visit(StorePast& past, const ForgetSet& chosen) {
    for (const auto& [entity, times] : chosen) all_ += times.size();
    for (const auto& [entity, times] : chosen) {
      ENGRAM_ASSIGN_OR_RETURN(const auto own, past.of(entity));
      if (!own) continue;
      ENGRAM_ASSIGN_OR_RETURN(const Packer packer, packer_like(past.store(), entity));
      for (const Time time : times) ENGRAM_RETURN_IF_ERROR(visit(*own, packer, entity, time));
    }
    return append();
  }

  /// Those that are to be forgotten, by RedactAction::kDrop.
  [[nodiscard]] const ForgetSet& dropped() const { return dropped_; }
  /// Plain bytes of those that were recorded anew.
  [[nodiscard]] const std::map<MemoryId, uint64_t>& raw_bytes() const { return raw_bytes_; }

 private:
  Status visit(EntityPast& past, const Packer& packer, const MemoryId& entity, Time time) {
    if (job_.stop.stop_requested()) return cancelled("redacting was stopped");
    if (job_.progress) job_.progress({"redact " + entity.to_string(), done_, all_, "", -1});
    ++done_;
    ENGRAM_RETURN_IF_ERROR(redactor_.wait_ready(job_.stop));
    ENGRAM_ASSIGN_OR_RETURN(RecalledSnapshot read, past.read(time, Prefer::kRecorded));
    Snapshot snapshot{entity, time, {}};
    for (InstanceResult& instance : read.answer.instances)
      snapshot.instances.push_back({std::move(instance.data), std::move(instance.metadata)});
    EntityRedaction& counts = report_.entities[entity];
    ++counts.looked_at;
    const RedactionOutcome outcome = redactor_.redact(snapshot);
    counts.boxes += outcome.boxes;
    counts.unanswered += outcome.is_unanswered ? 1 : 0;
    counts.unreadable += outcome.is_unreadable ? 1 : 0;
    if (outcome.is_unanswered || outcome.is_unreadable) return {};
    if (outcome.is_dropped()) {
      ++counts.dropped;
      dropped_[entity].insert(time);
      return {};
    }
    if (outcome.redacted == 0) return {};
    ++counts.redacted;
    return writer_ == nullptr ? Status() : record(packer, snapshot);
  }

  Status record(const Packer& packer, const Snapshot& snapshot) {
    PackedSnapshot packed{snapshot.entity, snapshot.time, {}, snapshot.raw_bytes(), 0, 0};
    for (const Instance& instance : snapshot.instances) {
      auto value = packer.pack(instance.data);
      if (!value.ok()) return value.status().with_context(snapshot.id().to_string());
      packed.instances.push_back({*std::move(value), instance.metadata});
    }
    waiting_bytes_ += packed.raw_bytes;
    raw_bytes_[snapshot.entity] += packed.raw_bytes;
    pending_[snapshot.entity].insert(snapshot.time);
    waiting_.push_back(std::move(packed));
    return waiting_bytes_ < kMaxAppendedBytes ? Status() : append();
  }

  /// Notes what is to go before its new form is there: if the process is killed in between, the
  /// next one knows of it.
  Status append() {
    if (waiting_.empty()) return {};
    ENGRAM_RETURN_IF_ERROR(write_pending_redaction(job_.store, pending_));
    ENGRAM_RETURN_IF_ERROR(writer_->append(waiting_, nullptr));
    waiting_.clear();
    waiting_bytes_ = 0;
    return {};
  }

  const StoreRedactionJob& job_;
  Redactor& redactor_;
  StoreWriter* const writer_;
  StoreRedaction& report_;
  ForgetSet& pending_;
  ForgetSet dropped_;
  std::map<MemoryId, uint64_t> raw_bytes_;
  std::vector<PackedSnapshot> waiting_;
  uint64_t waiting_bytes_ = 0;
  uint64_t done_ = 0, all_ = 0;
};

Result<ForgetSet> chosen_snapshots(const StoreRedactionJob& job) {
  ENGRAM_ASSIGN_OR_RETURN(auto reader, StoreReader::open(job.store));
  if (!job.targets.empty()) {
    Recall recall(std::move(reader), job.loader);
    return find_forget_targets(recall, job.targets);
  }
  ForgetSet chosen;
  for (const MemoryId& entity : reader->entities()) {
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader->timeline(entity));
    std::vector<Time> times;
    ENGRAM_RETURN_IF_ERROR(timeline->for_each([&times](const SnapshotEntry& entry) {
      times.push_back(entry.time);
      return Status();
    }));
    if (!times.empty()) chosen[entity] = TimeSet(std::move(times));
  }
  return chosen;
}

/// The augmented snapshots that were made of `gone`, and those made of these.
Result<ForgetSet> made_of(const std::filesystem::path& store, const ForgetSet& gone) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  ForgetPlan plan;
  for (const auto& [entity, times] : gone) plan.entities[entity].gone = times;
  ENGRAM_RETURN_IF_ERROR(add_made_of(*reader, plan));
  ForgetSet made;
  for (const auto& [entity, times] : plan.to_set()) {
    const auto known = gone.find(entity);
    for (const Time time : times)
      if (known == gone.end() || !known->second.contains(time)) made[entity].insert(time);
  }
  return made;
}

/// Counts the originals as forgotten and no longer as kept. They have as many plain bytes as what
/// was recorded in their place.
void count_forgotten(Manifest& manifest, const MemoryId& entity, uint64_t snapshots,
                     uint64_t raw_bytes) {
  ForgottenSums& sums = manifest.forgotten[entity];
  sums.snapshots += snapshots;
  sums.raw_bytes += raw_bytes;
  for (SegmentInfo& segment : manifest.segments)
    for (SegmentEntity& part : segment.entities) {
      if (segment.kind != SegmentKind::kRecorded || part.id != entity) continue;
      const uint64_t taken = std::min(part.raw_bytes, raw_bytes);
      part.raw_bytes -= taken;
      raw_bytes -= taken;
    }
}

/// Takes the originals of what was recorded anew, and what is to be forgotten, out of every file.
Status erase_originals(const StoreRedactionJob& job, const ForgetSet& redacted,
                       const SnapshotRedaction& seen, StoreRedaction& report) {
  ForgetSet gone = redacted;
  add_all(gone, seen.dropped());
  ENGRAM_ASSIGN_OR_RETURN(const ForgetSet made, made_of(job.store, gone));
  for (const auto& [entity, times] : made) report.made_of += times.size();
  add_all(gone, made);
  ENGRAM_ASSIGN_OR_RETURN(const Erasures coded,
                          job.code_anew(job.store, gone, job.progress, job.stop));
  ErasureReport& erased = report.erased.emplace();
  erased.add(coded);
  for (const auto& [entity, times] : redacted)
    ENGRAM_RETURN_IF_ERROR(remove_latents(job.store, entity, {}).status());
  ENGRAM_RETURN_IF_ERROR(
      remove_superseded_recorded(job.store, redacted, job.progress, job.stop).status());
  ForgetSet forgotten = seen.dropped();
  add_all(forgotten, made);
  if (!forgotten.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const RewriteReport rewritten,
                            forget_snapshots(job.store, forgotten, job.progress, job.stop));
    if (rewritten.is_cancelled) return cancelled("redacting was stopped");
  }
  // Models are told by this count from those that knew the originals
  // (training/fade/learned_from.h).
  ENGRAM_RETURN_IF_ERROR(edit_manifest(job.store, [&](Manifest& manifest) -> Status {
    for (const auto& [entity, times] : redacted) {
      const auto bytes = seen.raw_bytes().find(entity);
      count_forgotten(manifest, entity, times.size(),
                      bytes == seen.raw_bytes().end() ? 0 : bytes->second);
    }
    return {};
  }));
  for (const auto& [entity, times] : gone) erased.entities[entity].erased += times.size();
  // Copies of these days cannot tell by their times that what they hold was replaced.
  for (const auto& [entity, times] : redacted)
    for (const Time time : times) erased.entities[entity].redacted_days.insert(redacted_day(time));
  ENGRAM_ASSIGN_OR_RETURN(erased.files, remove_side_files(job.store, erased.entities));
  return write_erasure_report(job.store, system_now(), erased);
}

}  // namespace

EntityRedaction StoreRedaction::total() const {
  EntityRedaction sum;
  for (const auto& [id, entity] : entities) {
    sum.looked_at += entity.looked_at;
    sum.redacted += entity.redacted;
    sum.boxes += entity.boxes;
    sum.dropped += entity.dropped;
    sum.unanswered += entity.unanswered;
    sum.unreadable += entity.unreadable;
  }
  return sum;
}

nlohmann::ordered_json StoreRedaction::to_json() const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [id, entity] : entities)
    list.push_back({{"id", id.to_string()},
                    {"looked_at", entity.looked_at},
                    {"redacted", entity.redacted},
                    {"boxes", entity.boxes},
                    {"dropped", entity.dropped},
                    {"unanswered", entity.unanswered},
                    {"unreadable", entity.unreadable}});
  nlohmann::ordered_json json{{"entities", std::move(list)},
                              {"taken_up", taken_up},
                              {"made_of", made_of},
                              {"bytes_before", bytes_before},
                              {"bytes_after", bytes_after}};
  if (erased) {
    json["erased"] = erased->to_json();
    json["erased"]["report"] = erased->report;
  }
  return json;
}

Result<StoreRedaction> redact_store(const StoreRedactionJob& job) {
  StoreRedaction report;
  ENGRAM_ASSIGN_OR_RETURN(const auto redactor, Redactor::create({{EntityPattern(), job.options}}));
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_before, directory_bytes(job.store));
  std::optional<NightLock> lock;
  std::unique_ptr<StoreWriter> writer;
  ForgetSet redacted;
  if (!job.is_dry_run) {
    ENGRAM_ASSIGN_OR_RETURN(NightLock taken, NightLock::of_erasing(job.store));
    lock.emplace(std::move(taken));
    // What is in journals is sealed first. Nobody records meanwhile.
    ENGRAM_ASSIGN_OR_RETURN(writer, StoreWriter::open(job.store, {}));
    ENGRAM_RETURN_IF_ERROR(writer->seal());
    ENGRAM_ASSIGN_OR_RETURN(redacted, read_pending_redaction(job.store));
    for (const auto& [entity, times] : redacted) report.taken_up += times.size();
  }
  ENGRAM_ASSIGN_OR_RETURN(const ForgetSet chosen, chosen_snapshots(job));
  SnapshotRedaction seen(job, *redactor, writer.get(), report, redacted);
  {
    ENGRAM_ASSIGN_OR_RETURN(const auto past, StorePast::open(job.store, job.loader, {}));
    ENGRAM_RETURN_IF_ERROR(seen.visit(*past, chosen));
  }
  if (writer) {
    ENGRAM_RETURN_IF_ERROR(writer->seal());
    writer.reset();
    if (!redacted.empty() || !seen.dropped().empty())
      ENGRAM_RETURN_IF_ERROR(erase_originals(job, redacted, seen, report));
    ENGRAM_RETURN_IF_ERROR(write_pending_redaction(job.store, {}));
  }
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_after, directory_bytes(job.store));
  return report;
}

Result<uint64_t> pending_redactions(const std::filesystem::path& store) {
  ENGRAM_ASSIGN_OR_RETURN(const ForgetSet pending, read_pending_redaction(store));
  uint64_t count = 0;
  for (const auto& [entity, times] : pending) count += times.size();
  return count;
}

}  // namespace engram::ltm
