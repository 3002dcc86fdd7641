// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/redact_store.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ltm/forgetting/forget_plan.h"
#include "ltm/forgetting/pending_redaction.h"
#include "ltm/forgetting/plan_forgetting.h"
#include "ltm/forgetting/redacted_days.h"
#include "ltm/recall/recall.h"
#include "ltm/recall/store_past.h"
#include "ltm/store/night_lock.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/store_writer.h"
#include "ltm/store/superseded.h"

namespace engram::ltm {

namespace {

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

bool has_same_data(const Snapshot& a, const Snapshot& b) {
  return std::ranges::equal(a.instances, b.instances, {}, &Instance::data, &Instance::data);
}

/// Looks at snapshots, and records anew those in which something was found.
///
/// A run that goes on where a killed one ended finds nothing in what that one redacted, and yet
/// must hold the boxes of it: they stand in the file of what is pending.
class SnapshotRedaction {
 public:
  /// `writer` is null if nothing is to be changed. All must outlive this.
  SnapshotRedaction(const StoreRedactionJob& job, Redactor& redactor, StoreWriter* writer,
                    StoreRedaction& report, PendingRedaction& pending)
      : job_(job), redactor_(redactor), writer_(writer), report_(report), pending_(pending) {
    for (const auto& [id, entity] : pending.entities) {
      noted_[id] = entity.held;
      count_noted(entity, report.entities[id]);
    }
  }

  Status visit(StorePast& past, const ForgetSet& chosen) {
    for (const auto& [entity, times] : chosen) all_ += times.size();
    for (const auto& [entity, times] : chosen) {
      ENGRAM_ASSIGN_OR_RETURN(const auto own, past.of(entity));
      if (!own) continue;
      ENGRAM_ASSIGN_OR_RETURN(const Packer packer, packer_like(past.store(), entity));
      std::span<const PendingEntity::Held> noted = noted_[entity];
      for (const Time time : times) {
        for (; !noted.empty() && noted.front().time < time; noted = noted.subspan(1))
          redactor_.hold(entity, noted.front().time, {&noted.front().seen, 1});
        ENGRAM_RETURN_IF_ERROR(visit(*own, packer, entity, time));
      }
    }
    return append();
  }

 private:
  /// What killed runs did counts as if this one had done it.
  static void count_noted(const PendingEntity& entity, EntityRedaction& counts) {
    counts.redacted = entity.redacted.size();
    counts.dropped = entity.dropped.size();
    for (const auto& [time, of] : entity.redacted) counts.boxes += of.boxes;
    for (const auto& [time, boxes] : entity.dropped) counts.boxes += boxes;
  }

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
    const Snapshot before = snapshot;
    const RedactionOutcome outcome = redactor_.redact(snapshot);
    PendingEntity& pending = pending_.entities[entity];
    // It goes already, and was only looked at for the boxes that hold.
    if (pending.dropped.contains(time)) return {};
    counts.unanswered += outcome.is_unanswered ? 1 : 0;
    counts.unreadable += outcome.is_unreadable ? 1 : 0;
    if (outcome.is_unanswered || outcome.is_unreadable) return {};
    const auto noted = pending.redacted.find(time);
    const bool is_known = noted != pending.redacted.end();
    // A box that a killed run redacted already holds again, and changes nothing.
    const bool is_changed =
        outcome.is_dropped() || (outcome.redacted > 0 && !has_same_data(snapshot, before));
    if (is_changed || !is_known) counts.boxes += outcome.boxes;
    if (!is_changed) return {};
    if (outcome.is_dropped()) {
      ++counts.dropped;
      if (writer_ != nullptr) pending.dropped[time] = outcome.boxes;
      return {};
    }
    if (!is_known) ++counts.redacted;
    return writer_ == nullptr ? Status() : record(packer, snapshot, outcome);
  }

  Status record(const Packer& packer, const Snapshot& snapshot, const RedactionOutcome& outcome) {
    PackedSnapshot packed{snapshot.entity, snapshot.time, {}, snapshot.raw_bytes(), 0, 0};
    for (const Instance& instance : snapshot.instances) {
      auto value = packer.pack(instance.data);
      if (!value.ok()) return value.status().with_context(snapshot.id().to_string());
      packed.instances.push_back({*std::move(value), instance.metadata});
    }
    waiting_bytes_ += packed.raw_bytes;
    PendingEntity& entity = pending_.entities[snapshot.entity];
    PendingEntity::Redacted& redacted = entity.redacted[snapshot.time];
    redacted = {packed.raw_bytes, false, redacted.boxes + outcome.boxes};
    for (const SeenBox& box : outcome.seen) entity.held.push_back({snapshot.time, box});
    waiting_.push_back(std::move(packed));
    return waiting_bytes_ < job_.max_appended_bytes ? Status() : append();
  }

  /// Leaves out boxes that nothing after what was recorded anew needs, so that the note stays
  /// small.
  void leave_out_over(PendingEntity& entity) const {
    const int64_t last = to_ns(entity.redacted.rbegin()->first);
    const int64_t hold = job_.options.hold.count();
    std::erase_if(entity.held, [&](const PendingEntity::Held& held) {
      const auto since = static_cast<uint64_t>(last) - static_cast<uint64_t>(to_ns(held.time));
      return to_ns(held.time) < last && since > static_cast<uint64_t>(hold);
    });
    std::ranges::stable_sort(entity.held, {}, &PendingEntity::Held::time);
  }

  /// Notes what is to go before its new form is there: if the process is killed in between, the
  /// next one knows of it.
  Status append() {
    if (waiting_.empty()) return {};
    for (auto& [id, entity] : pending_.entities)
      if (!entity.redacted.empty()) leave_out_over(entity);
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
  PendingRedaction& pending_;
  std::map<MemoryId, std::vector<PendingEntity::Held>> noted_;  ///< By a killed run.
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

/// What a killed run noted, as far as it is true: without what it was killed ahead of recording
/// anew, and with what it counted already. What is not in the store at all stays in the note, since
/// blocks of others may show it.
Result<PendingRedaction> taken_up(const std::filesystem::path& store) {
  ENGRAM_ASSIGN_OR_RETURN(auto noted, read_pending_redaction(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  const Manifest& manifest = reader->manifest();
  if (!noted) return PendingRedaction{.first_segment = manifest.next_segment};
  for (auto& [id, entity] : noted->entities) {
    const auto sums = manifest.forgotten.find(id);
    if (entity.counting && sums != manifest.forgotten.end() &&
        sums->second.snapshots >= entity.counting->snapshots)
      for (auto& [time, of] : entity.redacted) of.is_counted = true;
    entity.counting.reset();
    if (!reader->has(id)) continue;
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader->timeline(id));
    for (auto next = entity.redacted.begin(); next != entity.redacted.end();) {
      ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(next->first));
      const bool is_there = entry && entry->time == next->first;
      const bool is_new =
          is_there && entry->recorded && entry->recorded->rows > 0 &&
          segment_number(manifest.segments[entry->recorded->source].file) >= noted->first_segment;
      next = is_there && !is_new ? entity.redacted.erase(next) : std::next(next);
    }
  }
  return *std::move(noted);
}

/// Counts the originals as forgotten and no longer as kept. They have as many plain bytes as what
/// was recorded in their place.
Status count_forgotten(Manifest& manifest, const MemoryId& entity,
                       const PendingEntity::Sums& more) {
  ForgottenSums& sums = manifest.forgotten[entity];
  sums.snapshots += more.snapshots;
  sums.raw_bytes += more.raw_bytes;
  uint64_t raw_bytes = more.raw_bytes;
  for (SegmentInfo& segment : manifest.segments) {
    if (segment.kind != SegmentKind::kRecorded || raw_bytes == 0) continue;
    if (segment.find(entity) == nullptr) continue;
    ENGRAM_RETURN_IF_ERROR(segment.entities.verify());
    std::vector<SegmentEntity>& parts = segment.entities.edit();
    SegmentEntity& part = *std::ranges::find(parts, entity, &SegmentEntity::id);
    const uint64_t taken = std::min(part.raw_bytes, raw_bytes);
    part.raw_bytes -= taken;
    raw_bytes -= taken;
  }
  return {};
}

/// Counts in the manifest what no run counted yet. Notes the sums first, by which the next run can
/// tell if this one is killed before it has removed the note.
///
/// Models are told by these counts from those that knew the originals
/// (training/fade/learned_from.h).
Status count_originals(const std::filesystem::path& store, PendingRedaction& pending) {
  ENGRAM_ASSIGN_OR_RETURN(const Manifest before, read_manifest(store));
  std::map<MemoryId, PendingEntity::Sums> uncounted;
  for (auto& [id, entity] : pending.entities) {
    PendingEntity::Sums sums;
    for (const auto& [time, of] : entity.redacted)
      if (!of.is_counted) {
        ++sums.snapshots;
        sums.raw_bytes += of.raw_bytes;
      }
    if (sums.snapshots == 0) continue;
    const auto known = before.forgotten.find(id);
    const ForgottenSums counted = known == before.forgotten.end() ? ForgottenSums() : known->second;
    entity.counting = {counted.snapshots + sums.snapshots, counted.raw_bytes + sums.raw_bytes};
    uncounted[id] = sums;
  }
  if (uncounted.empty()) return {};
  ENGRAM_RETURN_IF_ERROR(write_pending_redaction(store, pending));
  return edit_manifest(store, [&](Manifest& manifest) -> Status {
    for (const auto& [entity, sums] : uncounted)
      ENGRAM_RETURN_IF_ERROR(count_forgotten(manifest, entity, sums));
    return {};
  });
}

/// Takes the originals of what was recorded anew, and what is to be forgotten, out of every file.
Status erase_originals(const StoreRedactionJob& job, PendingRedaction& pending,
                       StoreRedaction& report) {
  const ForgetSet redacted = pending.redacted();
  ForgetSet gone = redacted;
  add_all(gone, pending.dropped());
  ENGRAM_ASSIGN_OR_RETURN(const ForgetSet found, made_of(job.store, gone));
  for (const auto& [entity, times] : found) pending.entities[entity].made.insert_all(times);
  // Noted before the first of them goes, since what holds from one to the next, and what tells of
  // those that were made of it, goes with it.
  ENGRAM_RETURN_IF_ERROR(write_pending_redaction(job.store, pending));
  const ForgetSet made = pending.made();
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
  ForgetSet forgotten = pending.dropped();
  add_all(forgotten, made);
  if (!forgotten.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const RewriteReport rewritten,
                            forget_snapshots(job.store, forgotten, job.progress, job.stop));
    if (rewritten.is_cancelled) return cancelled("redacting was stopped");
  }
  ENGRAM_RETURN_IF_ERROR(count_originals(job.store, pending));
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
  PendingRedaction pending;
  if (!job.is_dry_run) {
    ENGRAM_ASSIGN_OR_RETURN(NightLock taken, NightLock::of_erasing(job.store));
    lock.emplace(std::move(taken));
    // What is in journals is sealed first. Nobody records meanwhile.
    ENGRAM_ASSIGN_OR_RETURN(writer, StoreWriter::open(job.store, {}));
    ENGRAM_RETURN_IF_ERROR(writer->seal());
    ENGRAM_ASSIGN_OR_RETURN(pending, taken_up(job.store));
    report.taken_up = pending.snapshots();
    if (report.taken_up == 0) pending.bytes_before = report.bytes_before;
    report.bytes_before = pending.bytes_before;
  }
  ENGRAM_ASSIGN_OR_RETURN(const ForgetSet chosen, chosen_snapshots(job));
  {
    SnapshotRedaction seen(job, *redactor, writer.get(), report, pending);
    ENGRAM_ASSIGN_OR_RETURN(const auto past, StorePast::open(job.store, job.loader, {}));
    ENGRAM_RETURN_IF_ERROR(seen.visit(*past, chosen));
  }
  if (writer) {
    ENGRAM_RETURN_IF_ERROR(writer->seal());
    writer.reset();
    if (pending.snapshots() > 0) ENGRAM_RETURN_IF_ERROR(erase_originals(job, pending, report));
    ENGRAM_RETURN_IF_ERROR(remove_pending_redaction(job.store));
  }
  ENGRAM_ASSIGN_OR_RETURN(report.bytes_after, directory_bytes(job.store));
  return report;
}

Result<uint64_t> pending_redactions(const std::filesystem::path& store) {
  ENGRAM_ASSIGN_OR_RETURN(const auto pending, read_pending_redaction(store));
  return pending ? pending->snapshots() : 0;
}

}  // namespace engram::ltm
