// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/recorder.h"

#include <utility>

#include "ltm/codec/codec.h"
#include "ltm/filter/frequency_filter.h"
#include "ltm/store/manifest.h"

namespace engram::ltm {

struct Recorder::State {
  /// One entity on its way in.
  struct Channel {
    std::unique_ptr<Filter> filter;  ///< Null: everything is kept.
    uint64_t dropped = 0;            ///< Since the last snapshot that was kept.
    uint64_t dropped_bytes = 0;

    /// `packed` was not stored: what it told of is still to be told.
    void give_back(const PackedSnapshot& packed) {
      dropped += packed.dropped;
      dropped_bytes += packed.dropped_bytes;
    }
  };

  Options options;
  std::unique_ptr<StoreWriter> writer;
  std::map<MemoryId, Channel> channels;
  std::map<MemoryId, RecordingCounters> counters;

  Result<Channel*> channel(const MemoryId& entity) {
    if (const auto known = channels.find(entity); known != channels.end()) return &known->second;
    Channel made;
    if (options.max_rate_hz) {
      ENGRAM_ASSIGN_OR_RETURN(FrequencyFilter filter,
                              FrequencyFilter::create({.max_rate_hz = *options.max_rate_hz}));
      made.filter = std::make_unique<FrequencyFilter>(std::move(filter));
    }
    return &channels.emplace(entity, std::move(made)).first->second;
  }

  Status check(const Snapshot& snapshot) const {
    const std::optional<Time> last = writer->last_time(snapshot.entity);
    if (last && snapshot.time <= *last)
      return invalid_argument("entity '{}': time runs backwards: found {}, needs one after {}",
                              snapshot.entity.to_string(), to_string(snapshot.time),
                              to_string(*last));
    return {};
  }

  /// The snapshot with its values as their segment's type has them.
  Result<Snapshot> reinterpret(const Snapshot& snapshot) {
    Snapshot typed{snapshot.entity, snapshot.time, {}};
    for (const Instance& instance : snapshot.instances) {
      auto value = writer->types().reinterpret(snapshot.entity, instance.data);
      if (!value.ok()) return value.status();
      if (!value->notes.empty()) {
        RecordingCounters& counted = counters[snapshot.entity];
        ++counted.reinterpreted;
        counted.last_reinterpretation = value->notes.front().to_string();
      }
      typed.instances.push_back({std::move(value->value), instance.metadata});
    }
    return typed;
  }

  Result<PackedSnapshot> pack_snapshot(const Snapshot& snapshot, uint64_t raw_bytes) const {
    PackedSnapshot packed{snapshot.entity, snapshot.time, {}, raw_bytes, 0, 0};
    for (const Instance& instance : snapshot.instances) {
      auto value = pack(instance.data, options.pack);
      if (!value.ok()) return value.status().with_context(snapshot.id().to_string());
      packed.instances.push_back({std::move(value).value(), instance.metadata});
    }
    return packed;
  }

  /// What is kept of a commit, and the channels that it came through.
  struct Kept {
    std::vector<PackedSnapshot> snapshots;
    std::vector<Channel*> channels;
  };

  Status collect(const Commit& commit, Kept& kept) {
    ENGRAM_RETURN_IF_ERROR(commit.check());
    for (const Snapshot& offered : commit.updates) {
      ENGRAM_RETURN_IF_ERROR(check(offered));
      const bool is_typed = writer->types().of_entity(offered.entity) != nullptr;
      ENGRAM_ASSIGN_OR_RETURN(const Snapshot cast, is_typed ? reinterpret(offered) : Snapshot{});
      const Snapshot& snapshot = is_typed ? cast : offered;
      ENGRAM_ASSIGN_OR_RETURN(Channel * of, channel(snapshot.entity));
      RecordingCounters& counted = counters[snapshot.entity];
      const uint64_t raw_bytes = snapshot.raw_bytes();
      ++counted.offered;
      counted.offered_bytes += raw_bytes;
      if (of->filter != nullptr && !of->filter->keeps(snapshot)) {
        ++counted.dropped_by[std::string(of->filter->name())];
        ++of->dropped;
        of->dropped_bytes += raw_bytes;
        continue;
      }
      ENGRAM_ASSIGN_OR_RETURN(PackedSnapshot packed, pack_snapshot(snapshot, raw_bytes));
      packed.dropped = std::exchange(of->dropped, 0);
      packed.dropped_bytes = std::exchange(of->dropped_bytes, 0);
      kept.snapshots.push_back(std::move(packed));
      kept.channels.push_back(of);
    }
    return {};
  }
};

Status Recorder::Options::validate() const {
  if (max_rate_hz) ENGRAM_RETURN_IF_ERROR(FrequencyFilter::Options{*max_rate_hz}.validate());
  if (find_codec(pack.image_codec) == nullptr)
    return invalid_argument("unknown image codec '{}'", pack.image_codec);
  return {};
}

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder::~Recorder() = default;

Result<Recorder> Recorder::open(const std::filesystem::path& store, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  if (is_store_absent(store)) ENGRAM_RETURN_IF_ERROR(create_store(store));
  auto state = std::make_unique<State>();
  state->options = options;
  ENGRAM_ASSIGN_OR_RETURN(state->writer, StoreWriter::open(store, options.store));
  return Recorder(std::move(state));
}

Status Recorder::declare(const MemoryId& segment, const idf::Type& type) {
  return state_->writer->declare(segment, type);
}

Status Recorder::commit(const Commit& commit) {
  State::Kept kept;
  std::vector<uint64_t> frame_bytes;
  Status status = state_->collect(commit, kept);
  if (status.ok()) status = state_->writer->append(kept.snapshots, &frame_bytes);
  if (!status.ok()) {
    for (size_t i = 0; i < kept.snapshots.size(); ++i)
      kept.channels[i]->give_back(kept.snapshots[i]);
    return status;
  }
  for (size_t i = 0; i < kept.snapshots.size(); ++i) {
    RecordingCounters& counters = state_->counters[kept.snapshots[i].entity];
    ++counters.kept;
    counters.kept_bytes += kept.snapshots[i].raw_bytes;
    counters.stored_bytes += frame_bytes[i];
  }
  return {};
}

Status Recorder::close() {
  for (auto& [entity, channel] : state_->channels) {
    if (channel.dropped == 0) continue;
    ENGRAM_RETURN_IF_ERROR(
        state_->writer->append_dropped(entity, channel.dropped, channel.dropped_bytes));
    channel.dropped = channel.dropped_bytes = 0;
  }
  return state_->writer->seal();
}

std::optional<Time> Recorder::last_time(const MemoryId& entity) const {
  return state_->writer->last_time(entity);
}

uint64_t Recorder::lost_frames() const {
  return state_->writer->lost_frames();
}

const std::map<MemoryId, RecordingCounters>& Recorder::counters() const {
  return state_->counters;
}

}  // namespace engram::ltm
