// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/recorder.h"

#include <algorithm>
#include <utility>

#include "ltm/core/log.h"
#include "ltm/memory/links.h"
#include "ltm/recording/entity_seal_rules.h"
#include "ltm/recording/offered_snapshot.h"
#include "ltm/recording/recording_channel.h"
#include "ltm/recording/redaction_rules.h"
#include "ltm/recording/worker_pool.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

namespace {

/// Commits of fewer plain bytes are encoded by the caller alone, without waking other threads.
constexpr uint64_t kMinSharedBytes = 64 << 10;
/// Max plain bytes that left the filters and wait in memory for a failing disk.
constexpr uint64_t kMaxPendingBytes = uint64_t{256} << 20;

/// A snapshot that filters kept.
struct Kept {
  RecordingChannel* channel = nullptr;
  const Snapshot* borrowed = nullptr;  ///< Of the running commit; null if `candidate` has it.
  Candidate candidate;
  std::optional<PackedSnapshot> packed;

  [[nodiscard]] const Snapshot& snapshot() const {
    return borrowed == nullptr ? candidate.snapshot : *borrowed;
  }
};

bool may_work_later(const Status& status) {
  return status.code() == StatusCode::kUnavailable ||
         status.code() == StatusCode::kResourceExhausted;
}

}  // namespace

struct Recorder::State {
  Options options;
  Clock clock;
  std::unique_ptr<StoreWriter> writer;
  std::shared_ptr<Redactor> redactor;  ///< Null if nothing is redacted.
  RecordingChannels channels;
  WorkerPool workers;
  uint64_t commits = 0;
  /// Snapshots of earlier commits that could not be stored when filters released them: the disk
  /// failed.
  std::vector<Kept> pending;
  Time last_notes;

  State(const Options& chosen, Clock now, std::unique_ptr<StoreWriter> store,
        std::shared_ptr<Redactor> redacting)
      : options(chosen),
        clock(std::move(now)),
        writer(std::move(store)),
        redactor(std::move(redacting)),
        channels(options),
        workers(options.threads),
        last_notes(clock()) {}

  Status check_order(const Snapshot& snapshot) const {
    if (options.late == LateSnapshots::kKeep) return {};
    const std::optional<Time> last = writer->last_time(snapshot.entity);
    if (last && snapshot.time <= *last)
      return invalid_argument("entity '{}': time runs backwards: found {}, needs one after {}",
                              snapshot.entity.to_string(), to_string(snapshot.time),
                              to_string(*last));
    return {};
  }

  /// Those of working memory were checked when they came, by its limits.
  static Status check_time(const CheckedSnapshot&) { return {}; }
  Status check_time(const Snapshot& snapshot) const {
    const Time now = clock();
    if (snapshot.time <= now) return {};
    const auto rule = std::ranges::find_if(
        options.rules, [&](const EntityRule& each) { return each.match.matches(snapshot.entity); });
    const auto of_rule = rule == options.rules.end() ? std::nullopt : rule->max_ahead;
    return check_ahead(snapshot.entity, snapshot.time, now, of_rule.value_or(options.max_ahead));
  }

  /// Checks the whole commit before any of it reaches a filter, so that a refused commit has no
  /// effect.
  template <typename Update>
  Result<std::vector<OfferedSnapshot>> prepare(std::span<const Update* const> updates) const {
    const std::vector<const Snapshot*> plain(updates.begin(), updates.end());
    ENGRAM_RETURN_IF_ERROR(check_updates(plain));
    std::vector<OfferedSnapshot> all;
    all.reserve(updates.size());
    for (const Update* update : updates) {
      ENGRAM_RETURN_IF_ERROR(check_order(*update));
      ENGRAM_RETURN_IF_ERROR(check_time(*update));
      ENGRAM_ASSIGN_OR_RETURN(auto offered, OfferedSnapshot::of(*update, writer->types()));
      all.push_back(std::move(offered));
    }
    return all;
  }

  void redact(std::vector<OfferedSnapshot>& offered) {
    if (!redactor) return;
    for (OfferedSnapshot& each : offered)
      if (!each.is_redacted) each.redact(*redactor);
  }

  template <typename Update>
  Status commit(std::span<const Update* const> updates) {
    ENGRAM_ASSIGN_OR_RETURN(std::vector<OfferedSnapshot> offered, prepare(updates));
    redact(offered);
    ++commits;
    std::vector<Kept> kept;
    kept.reserve(offered.size());
    for (const OfferedSnapshot& each : offered) filter(each, kept);
    keep_linked(kept);
    ENGRAM_RETURN_IF_ERROR(store(kept));
    note_drops_if_due();
    return {};
  }

  static void count(const OfferedSnapshot& offered, RecordingCounters& counters) {
    ++counters.offered;
    counters.offered_bytes += offered.raw_bytes;
    counters.reinterpreted += offered.notes.size();
    if (!offered.notes.empty()) counters.last_reinterpretation = offered.notes.back();
    counters.redacted_images += offered.redaction.redacted;
    counters.redacted_boxes += offered.redaction.boxes;
    counters.redact_unanswered += offered.redaction.is_unanswered ? 1 : 0;
    counters.redact_unreadable += offered.redaction.is_unreadable ? 1 : 0;
  }

  static void drop(RecordingChannel& channel, const OfferedSnapshot& offered) {
    ++channel.counters->redact_dropped;
    ++channel.dropped;
    channel.dropped_bytes += offered.raw_bytes;
  }

  static void take_output(RecordingChannel& channel, FilterChain::Output output,
                          std::vector<Kept>& kept) {
    channel.dropped += output.dropped;
    channel.dropped_bytes += output.dropped_bytes;
    for (Candidate& candidate : output.kept)
      kept.push_back({&channel, nullptr, std::move(candidate), std::nullopt});
  }

  void filter(const OfferedSnapshot& offered, std::vector<Kept>& kept) {
    const Snapshot& snapshot = offered.snapshot();
    RecordingChannel& channel = channels.of(snapshot.entity);
    count(offered, *channel.counters);
    if (offered.redaction.is_dropped()) return drop(channel, offered);
    std::optional<idf::Type> type;
    if (channel.is_event_source || !channel.chain.empty())
      if (const idf::Type* declared = writer->types().of_entity(snapshot.entity)) type = *declared;
    if (channel.is_event_source) {
      channel.last_offered = snapshot;
      channel.last_type = type;
    }
    if (channel.chain.empty()) {
      Candidate counted;
      counted.raw_bytes = offered.raw_bytes;
      counted.commit = commits;
      kept.push_back({&channel, &snapshot, std::move(counted), std::nullopt});
    } else {
      FilterChain::Output output;
      channel.chain.offer({snapshot, offered.raw_bytes, commits, type}, output);
      take_output(channel, std::move(output), kept);
    }
    for (RecordingChannel* listener : channel.listeners) {
      FilterChain::Output output;
      listener->chain.notice(snapshot, type, output);
      take_output(*listener, std::move(output), kept);
    }
  }

  /// Keeps what filters dropped and what is kept links to; that may link to more.
  void keep_linked(std::vector<Kept>& kept) {
    if (!channels.keeps_linked()) return;
    for (size_t i = 0; i < kept.size(); ++i)
      for (const MemoryId& id : linked_by(kept[i].snapshot())) {
        RecordingChannel* channel = channels.find(id.entity());
        if (channel == nullptr) continue;
        FilterChain::Output output;
        channel->chain.want(*id.time(), output);
        take_output(*channel, std::move(output), kept);
      }
  }

  /// The snapshots that a snapshot links to.
  std::vector<MemoryId> linked_by(const Snapshot& snapshot) const {
    const idf::Type* type = writer->types().of_entity(snapshot.entity);
    std::vector<MemoryId> linked;
    for (const Instance& instance : snapshot.instances)
      for (const Link& link :
           type != nullptr ? find_links(instance.data, *type) : find_links(instance.data))
        if (link.id.has_entity() && link.id.time()) linked.push_back(link.id);
    return linked;
  }

  bool drop_unmade(const MemoryId& entity, Time time, uint64_t raw_bytes) {
    RecordingChannel& channel = channels.of(entity);
    // Other entities may find an event in the value, so it must be made.
    if (channel.is_event_source || !channel.listeners.empty()) return false;
    FilterChain::Output output;
    if (!channel.chain.drop_at(time, raw_bytes, output)) return false;
    ++channel.counters->offered;
    channel.counters->offered_bytes += raw_bytes;
    channel.dropped += output.dropped;
    channel.dropped_bytes += output.dropped_bytes;
    return true;
  }

  /// Encodes what is not encoded yet, in parallel if there are enough bytes. Snapshots that an
  /// earlier attempt encoded keep their bytes, so a retry only writes.
  Status pack_all(std::vector<Kept>& kept) {
    struct Part {
      Kept* kept;
      size_t instance;
      std::optional<Result<PackedValue>> value;
    };
    std::vector<Part> parts;
    uint64_t bytes = 0;
    for (Kept& each : kept) {
      if (each.packed) continue;
      bytes += each.candidate.raw_bytes;
      for (size_t i = 0; i < each.snapshot().instances.size(); ++i) parts.push_back({&each, i, {}});
    }
    const auto work = [&parts](size_t i) {
      const Kept& from = *parts[i].kept;
      parts[i].value = from.channel->packer.pack(from.snapshot().instances[parts[i].instance].data);
    };
    if (bytes < kMinSharedBytes)
      for (size_t i = 0; i < parts.size(); ++i) work(i);
    else
      workers.run(parts.size(), work);
    for (const Part& part : parts)
      if (!part.value->ok())
        return part.value->status().with_context(part.kept->snapshot().id().to_string());
    for (Part& part : parts) {
      const Snapshot& snapshot = part.kept->snapshot();
      if (part.instance == 0)
        part.kept->packed = PackedSnapshot{
            snapshot.entity, snapshot.time, {}, part.kept->candidate.raw_bytes, 0, 0};
      part.kept->packed->instances.push_back(
          {std::move(*part.value).value(), snapshot.instances[part.instance].metadata});
    }
    return {};
  }

  /// Appends all snapshots or none. The first one of each entity carries the counts of dropped
  /// snapshots, which go back to the channel if the append fails.
  Status append(std::vector<Kept>& kept) {
    std::vector<PackedSnapshot> packed;
    for (Kept& each : kept) {
      each.packed->dropped = std::exchange(each.channel->dropped, 0);
      each.packed->dropped_bytes = std::exchange(each.channel->dropped_bytes, 0);
      packed.push_back(std::move(*each.packed));
    }
    std::vector<uint64_t> frame_bytes;
    const Status status = writer->append(packed, &frame_bytes);
    for (size_t i = 0; i < kept.size(); ++i) {
      RecordingChannel& channel = *kept[i].channel;
      if (status.ok()) {
        ++channel.counters->kept;
        channel.counters->kept_bytes += kept[i].candidate.raw_bytes;
        channel.counters->stored_bytes += frame_bytes[i];
        if (options.on_released && kept[i].candidate.commit != commits)
          options.on_released(kept[i].snapshot().id());
        continue;
      }
      channel.dropped += packed[i].dropped;
      channel.dropped_bytes += packed[i].dropped_bytes;
      kept[i].packed = std::move(packed[i]);
    }
    return status;
  }

  Status store(std::vector<Kept>& kept) {
    for (Kept& each : pending) {
      --each.channel->pending;
      each.channel->pending_bytes -= each.candidate.raw_bytes;
    }
    kept.insert(kept.begin(), std::make_move_iterator(pending.begin()),
                std::make_move_iterator(pending.end()));
    pending.clear();
    if (kept.empty()) return {};
    Status status = pack_all(kept);
    if (status.ok()) status = append(kept);
    if (!status.ok()) fail(kept, status);
    return status;
  }

  /// Handles a failed append. Snapshots of the running commit are not acknowledged, so the caller
  /// may send them again. Those of earlier commits, which filters had held, were acknowledged: they
  /// wait for the next commit or, if waiting cannot help or too much waits, are stored alone.
  void fail(std::vector<Kept>& kept, const Status& status) {
    uint64_t bytes = 0;
    for (Kept& each : kept) {
      if (each.candidate.commit == commits) {
        ++each.channel->counters->failed;
        continue;
      }
      bytes += each.candidate.raw_bytes;
      if (may_work_later(status) && bytes <= kMaxPendingBytes) {
        ++each.channel->pending;
        each.channel->pending_bytes += each.candidate.raw_bytes;
        pending.push_back(std::move(each));
      } else {
        store_alone(std::move(each));
      }
    }
  }

  void store_alone(Kept kept) {
    const std::string id = kept.snapshot().id().to_string();
    RecordingCounters& counters = *kept.channel->counters;
    std::vector<Kept> one;
    one.push_back(std::move(kept));
    Status status = pack_all(one);
    if (status.ok()) status = append(one);
    if (status.ok()) return;
    ++counters.failed;
    log::warning("snapshot '{}', which a filter had held, is lost: {}", id, status.to_string());
  }

  void forget(const std::map<MemoryId, TimeSet>& gone) {
    for (const auto& [entity, times] : gone) {
      const auto found = channels.all().find(entity);
      if (found == channels.all().end()) continue;
      RecordingChannel& channel = found->second;
      FilterChain::Output output;
      channel.chain.forget(times, output);
      channel.dropped += output.dropped;
      channel.dropped_bytes += output.dropped_bytes;
      channel.last_offered.reset();
    }
    std::erase_if(pending, [&gone](const Kept& each) {
      const auto times = gone.find(each.snapshot().entity);
      if (times == gone.end() || !times->second.contains(each.snapshot().time)) return false;
      --each.channel->pending;
      each.channel->pending_bytes -= each.candidate.raw_bytes;
      ++each.channel->counters->failed;
      return true;
    });
  }

  /// Stores what filters hold, and seals the store.
  Status finish() {
    ++commits;
    std::vector<Kept> kept;
    for (auto& [entity, channel] : channels.all()) {
      FilterChain::Output output;
      channel.chain.flush(output);
      take_output(channel, std::move(output), kept);
    }
    keep_linked(kept);
    for (auto& [entity, channel] : channels.all()) {
      FilterChain::Output output;
      channel.chain.drop_unlinked(output);
      take_output(channel, std::move(output), kept);
    }
    ENGRAM_RETURN_IF_ERROR(store(kept));
    ENGRAM_RETURN_IF_ERROR(note_drops());
    return writer->seal();
  }

  Status note_drops() {
    last_notes = clock();
    for (auto& [entity, channel] : channels.all()) {
      note_reasons(channel);
      if (channel.dropped == 0) continue;
      ENGRAM_RETURN_IF_ERROR(
          writer->append_dropped(entity, channel.dropped, channel.dropped_bytes));
      channel.dropped = channel.dropped_bytes = 0;
    }
    return {};
  }

  void note_reasons(RecordingChannel& channel) {
    channel.count();
    for (const auto& [filter, count] : channel.counters->dropped_by) {
      uint64_t& noted = channel.noted_by[filter];
      if (count > noted) writer->note_dropped_by(channel.entity, filter, count - noted);
      noted = count;
    }
  }

  /// Notes the counts of dropped snapshots if the interval has passed. If it fails, the counts stay
  /// and are noted later: a commit does not fail for its counts.
  void note_drops_if_due() {
    const Time now = clock();
    if (now >= last_notes && now - last_notes < options.drop_note_interval) return;
    if (const Status status = note_drops(); !status.ok())
      log::warning("counts of dropped snapshots are not stored yet: {}", status.to_string());
  }
};

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder::~Recorder() = default;

Result<Recorder> Recorder::open(const std::filesystem::path& store, const Options& options,
                                Clock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(auto redactor, make_redactor(options.rules));
  return open(store, options, std::move(clock), std::move(redactor));
}

Result<Recorder> Recorder::open(const std::filesystem::path& store, const Options& options,
                                Clock clock, std::shared_ptr<Redactor> redactor) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  if (is_store_absent(store)) ENGRAM_RETURN_IF_ERROR(create_store(store));
  StoreWriter::Options writing = options.store;
  if (!writing.seal_rules) writing.seal_rules = seal_rules_of(options);
  ENGRAM_ASSIGN_OR_RETURN(auto writer, StoreWriter::open(store, writing, clock));
  return Recorder(
      std::make_unique<State>(options, std::move(clock), std::move(writer), std::move(redactor)));
}

Status Recorder::declare(const MemoryId& segment, const idf::Type& type) {
  return state_->writer->declare(segment, type);
}

Status Recorder::commit(const Commit& commit) {
  return state_->commit<Snapshot>(pointers_to(commit.updates));
}

Status Recorder::commit_checked(std::span<const CheckedSnapshot* const> updates) {
  return state_->commit(updates);
}

const SegmentTypes& Recorder::types() const {
  return state_->writer->types();
}

bool Recorder::drop_unmade(const MemoryId& entity, Time time, uint64_t raw_bytes) {
  if (!state_->drop_unmade(entity, time, raw_bytes)) return false;
  state_->note_drops_if_due();
  return true;
}

std::map<MemoryId, TimeSet> Recorder::waiting_times() const {
  std::map<MemoryId, TimeSet> waiting;
  for (const auto& [entity, channel] : state_->channels.all()) {
    TimeSet times;
    channel.chain.add_held_times(times);
    if (!times.empty()) waiting[entity] = std::move(times);
  }
  for (const Kept& each : state_->pending)
    waiting[each.snapshot().entity].insert(each.snapshot().time);
  return waiting;
}

void Recorder::forget(const std::map<MemoryId, TimeSet>& gone) {
  state_->forget(gone);
}

Status Recorder::seal() {
  return state_->writer->seal();
}

Status Recorder::close() {
  Status status = state_->finish();
  if (status.ok()) return status;
  const Status forced = state_->writer->sync();
  if (forced.ok()) return status;
  return status.with_context(
      fmt::format("a power cut may cost what was kept last ({})", forced.message()));
}

std::optional<Time> Recorder::last_time(const MemoryId& entity) const {
  return state_->writer->last_time(entity);
}

uint64_t Recorder::lost_frames() const {
  return state_->writer->lost_frames();
}

const std::map<MemoryId, RecordingCounters>& Recorder::counters() const {
  return state_->channels.counters();
}

}  // namespace engram::ltm
