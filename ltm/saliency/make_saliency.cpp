// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/make_saliency.h"

#include <algorithm>
#include <map>

#include "ltm/core/log.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/recall/access_log.h"
#include "ltm/saliency/entity_scoring.h"
#include "ltm/saliency/learn_weights.h"
#include "ltm/saliency/pending_saliency.h"
#include "ltm/saliency/saliency_table.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

constexpr uint64_t kProgressStep = 1024;

/// What segments already have of an entity.
struct KnownSaliency {
  EntitySaliency all;
  std::map<uint32_t, uint64_t> counts;  ///< By segment: how many rows it has.

  [[nodiscard]] uint64_t count_in(uint32_t segment) const {
    const auto found = counts.find(segment);
    return found == counts.end() ? 0 : found->second;
  }
};

/// How many snapshots belong into the index of each segment.
std::map<uint32_t, uint64_t> rows_by_segment(const std::vector<SnapshotEntry>& entries) {
  std::map<uint32_t, uint64_t> rows;
  for (const SnapshotEntry& entry : entries)
    if (const auto segment = segment_of_code(entry)) ++rows[*segment];
  return rows;
}

class SaliencyJob {
 public:
  SaliencyJob(StorePast& past, const SaliencyOptions& options, const ProgressSink& progress,
              const std::stop_token& stop)
      : past_(past), options_(options), progress_(progress), stop_(stop), pending_(past.store()) {}

  Status run() {
    read_known();
    std::map<MemoryId, std::vector<MemoryId>> by_provider;
    for (const MemoryId& entity : past_.store().entities())
      if (!options_.matches || options_.matches(entity))
        by_provider[entity.parent()].push_back(entity);
    for (const auto& [provider, entities] : by_provider) {
      units_.reset();
      for (const MemoryId& entity : entities) {
        if (is_over()) break;
        const Status scored = score(entity);
        if (scored.ok()) continue;
        if (scored.code() == StatusCode::kCancelled ||
            scored.code() == StatusCode::kResourceExhausted ||
            scored.code() == StatusCode::kUnavailable)
          return scored;
        log::warning("store '{}': '{}' has no saliency: {}", past_.store().path().string(),
                     entity.to_string(), scored.message());
      }
    }
    ENGRAM_RETURN_IF_ERROR(pending_.write());
    if (stop_.stop_requested())
      return cancelled("'{}': calculating saliency", past_.store().path().string());
    if (progress_ && report.snapshots > 0)
      progress_({"calculate saliency", report.snapshots, report.snapshots, "", -1});
    return {};
  }

  SaliencyReport report;

 private:
  void read_known() {
    for_each_saliency(past_.store(), [this](uint32_t segment, const EntitySaliency& one) {
      KnownSaliency& known = known_[one.entity];
      known.counts[segment] += one.times.size();
      known.all.entity = one.entity;
      known.all.append(one);
    });
    for (auto& [entity, known] : known_) sort_by_time(known.all);
  }

  /// The snapshots from the first one on of which nothing is known. Those behind it may be told
  /// differently by it. What is there moves to the segments in which the snapshots are now.
  Status score(const MemoryId& entity) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entries, entries_of(past_.store(), entity));
    const KnownSaliency& known = known_[entity];
    const EntitySaliency& rows = known.all;
    const auto needed = rows_by_segment(entries);
    const bool has_all = std::ranges::all_of(
        needed, [&](const auto& each) { return known.count_in(each.first) >= each.second; });
    const bool is_stale =
        std::ranges::find(rows.rows, RowState::kStale, &SaliencyRow::state) != rows.rows.end();
    if (has_all && !is_stale) return {};
    size_t first = 0;
    for (; first < entries.size() && first < rows.times.size() &&
           entries[first].time == rows.times[first] && rows.rows[first].state != RowState::kStale;
         ++first) {
      const auto segment = segment_of_code(entries[first]);
      if (segment && known.count_in(*segment) < needed.at(*segment))
        pending_.add(entity, entries[first], rows.rows[first]);
    }
    if (first == entries.size()) return {};
    if (!units_) {
      ENGRAM_ASSIGN_OR_RETURN(units_, measure_units(past_, entities_beside(past_.store(), entity),
                                                    [this] { return is_over(); }));
    }
    const uint64_t before = report.snapshots;
    const auto take = [&](const SnapshotEntry& entry, SaliencyRow row) -> Status {
      if (const auto there = rows.find(entry.time)) row.stands_for = rows.rows[*there].stands_for;
      pending_.add(entity, entry, row);
      ++report.snapshots;
      return pending_.is_full() ? pending_.write() : Status();
    };
    uint64_t asked = 0;
    const auto is_over_now = [&] {
      if (progress_ && asked++ % kProgressStep == 0)
        progress_({"calculate saliency", report.snapshots, 0, entity.to_string(), -1});
      return is_over();
    };
    ENGRAM_RETURN_IF_ERROR(score_entity(past_, entity, *units_, entries, first, is_over_now, take));
    report.entities += report.snapshots > before ? 1 : 0;
    return {};
  }

  [[nodiscard]] bool is_over() const {
    return stop_.stop_requested() || (options_.is_over && options_.is_over());
  }

  StorePast& past_;
  const SaliencyOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  PendingSaliency pending_;
  std::map<MemoryId, KnownSaliency> known_;  ///< 28 bytes for each snapshot.
  std::optional<MemberUnits> units_;         ///< Of the provider segment at hand.
};

/// Learns weights from what was read.
Result<SaliencyWeights> learn_from_reads(StoreReader& store) {
  const AccessTable accesses = read_accesses(store.path());
  if (accesses.all().empty()) return stored_weights(store.path());
  WeightLearner learner;
  const auto known = all_saliency(store);
  for (const auto& [entity, snapshots] : accesses.all()) {
    const auto found = known.find(entity);
    if (found == known.end() || !store.has(entity)) continue;
    const EntitySaliency saliency = found->second.known_rows();
    std::vector<bool> read(saliency.times.size(), false);
    for (size_t i = 0; i < read.size(); ++i) read[i] = snapshots.contains(saliency.times[i]);
    learner.add(saliency, read);
  }
  const SaliencyWeights weights = learner.learn();
  if (weights.learned_from == 0) return stored_weights(store.path());
  ENGRAM_RETURN_IF_ERROR(publish_entity_index(store.path(), store.manifest(), weights_entity(),
                                              kWeightsIndex, pack_weights(weights)));
  return weights;
}

}  // namespace

std::vector<MemoryId> entities_beside(StoreReader& store, const MemoryId& entity) {
  std::vector<MemoryId> found;
  for (const MemoryId& other : store.entities())
    if (other.parent() == entity.parent()) found.push_back(other);
  return found;
}

Result<SaliencyReport> make_saliency(const std::filesystem::path& store, const ModelLoader& loader,
                                     const SaliencyOptions& options, const ProgressSink& progress,
                                     const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto past, StorePast::open(store, loader, {}));
  SaliencyReport report;
  {
    SaliencyJob job(*past, options, progress, stop);
    ENGRAM_RETURN_IF_ERROR(job.run());
    report = job.report;
  }
  ENGRAM_ASSIGN_OR_RETURN(report.weights, learn_from_reads(past->store()));
  return report;
}

}  // namespace engram::ltm
