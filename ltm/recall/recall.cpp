// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recall.h"

#include <algorithm>

#include "ltm/recall/select.h"

namespace engram::ltm {

namespace {

/// Leaves the instances that are asked for. False where none of them exists.
bool keep_selected(SnapshotResult& snapshot, const std::vector<int32_t>& instances) {
  if (instances.empty()) return true;
  std::erase_if(snapshot.instances, [&instances](const InstanceResult& instance) {
    return !std::ranges::binary_search(instances, instance.index);
  });
  return !snapshot.instances.empty();
}

/// The times of a store's entity.
class TimelineMoments final : public Moments {
 public:
  explicit TimelineMoments(Timeline& timeline) : timeline_(timeline) {}

  [[nodiscard]] std::optional<Time> first() const override { return timeline_.first(); }
  [[nodiscard]] std::optional<Time> last() const override { return timeline_.last(); }
  Result<std::optional<Time>> at_or_after(Time time) override {
    return time_of(timeline_.at_or_after(time));
  }
  Result<std::optional<Time>> at_or_before(Time time) override {
    return time_of(timeline_.at_or_before(time));
  }
  Result<std::optional<Time>> nth(uint64_t index) override { return time_of(timeline_.nth(index)); }

 private:
  static Result<std::optional<Time>> time_of(const Result<std::optional<SnapshotEntry>>& entry) {
    if (!entry.ok()) return entry.status();
    return entry.value() ? std::optional((*entry)->time) : std::nullopt;
  }

  Timeline& timeline_;
};

}  // namespace

struct Recall::State {
  PastReader past;
  Forecaster forecaster;
  std::unique_ptr<AccessLog> accesses;  ///< May be null.

  State(std::unique_ptr<StoreReader> store, ModelLoader loader, std::unique_ptr<AccessLog> notes,
        MakeEngineChoice make_choice)
      : past(std::move(store), std::move(loader)),
        forecaster(past, std::move(make_choice)),
        accesses(std::move(notes)) {}

  /// The instances of a prediction without their data.
  Result<SnapshotResult> name_future(const MemoryId& entity, const SnapshotEntry& last, Time when,
                                     Prefer prefer) {
    ENGRAM_ASSIGN_OR_RETURN(SnapshotResult named, past.name(entity, last, prefer));
    named.time = when;
    named.source = Source::kPredicted;
    named.horizon = when - last.time;
    return named;
  }

  Result<SnapshotResult> answer(const MemoryId& entity, Timeline& timeline,
                                const SelectedSnapshot& selected, bool is_ids_only,
                                const Options& options) {
    if (selected.is_future && !is_ids_only) {
      const Duration horizon = selected.time - *timeline.last();
      ENGRAM_ASSIGN_OR_RETURN(
          auto predicted,
          forecaster.predict(entity, {{}, {horizon}, ""}, options.prefer, options.max_steps));
      return std::move(predicted.front());
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline.at_or_before(selected.time));
    ENGRAM_CHECK(entry.has_value(), "'{}' was selected", entity.at(selected.time).to_string());
    if (selected.is_future) return name_future(entity, *entry, selected.time, options.prefer);
    return is_ids_only ? past.name(entity, *entry, options.prefer)
                       : past.read(entity, *entry, options.prefer);
  }

  Status answer(const Query& query, const Options& options, EntityResult& result) {
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, past.store().timeline(result.id));
    TimelineMoments moments(*timeline);
    ENGRAM_ASSIGN_OR_RETURN(const auto selection,
                            select_snapshots(query.snapshots_of(result.id), moments));
    for (const SelectedSnapshot& selected : selection) {
      ENGRAM_ASSIGN_OR_RETURN(SnapshotResult snapshot,
                              answer(result.id, *timeline, selected, query.is_ids_only(), options));
      if (!keep_selected(snapshot, selected.instances)) continue;
      if (accesses && !selected.is_future && !query.is_ids_only())
        accesses->note(result.id, snapshot.time);
      result.add(std::move(snapshot));
    }
    return {};
  }
};

Recall::Recall(std::unique_ptr<StoreReader> store, ModelLoader loader,
               std::unique_ptr<AccessLog> accesses, MakeEngineChoice make_choice)
    : state_(std::make_unique<State>(std::move(store), std::move(loader), std::move(accesses),
                                     std::move(make_choice))) {}

Recall::~Recall() = default;

StoreReader& Recall::store() {
  return state_->past.store();
}

Result<std::vector<Engine>> Recall::engines(const MemoryId& entity) {
  ENGRAM_RETURN_IF_ERROR(state_->past.store().timeline(entity).status());
  return state_->forecaster.engines(entity);
}

Result<Engine> Recall::engine(const MemoryId& entity, const std::string& name) {
  ENGRAM_RETURN_IF_ERROR(state_->past.store().timeline(entity).status());
  return state_->forecaster.engine(entity, name);
}

Result<std::vector<EngineRecord>> Recall::records(const MemoryId& entity, std::optional<Time> from,
                                                  Duration ahead, const Options& options) {
  return state_->forecaster.records(entity, from, ahead, options.prefer);
}

Result<std::vector<SnapshotResult>> Recall::predict(const MemoryId& entity, const Outlook& outlook,
                                                    const Options& options) {
  if (outlook.horizons.empty())
    return invalid_argument("entity '{}': found no horizon to predict, needs one",
                            entity.to_string());
  return state_->forecaster.predict(entity, outlook, options.prefer, options.max_steps);
}

Result<QueryResult> Recall::query(const Query& query, const Options& options) {
  QueryResult result(query.is_ids_only());
  bool is_any = false;
  std::string known;
  for (const MemoryId& entity : state_->past.store().entities()) {
    known += (known.empty() ? "" : ", ") + entity.to_string();
    if (!query.matches(entity)) continue;
    is_any = true;
    ENGRAM_RETURN_IF_ERROR(state_->answer(query, options, result.add_entity(entity)));
  }
  if (!is_any)
    return not_found("store '{}': no entity matches '{}'; it has: {}",
                     state_->past.store().path().string(), query.to_string(),
                     known.empty() ? "none" : known);
  return result;
}

}  // namespace engram::ltm
