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
  std::vector<std::pair<uint32_t, uint64_t>> rows;  ///< By segment: how many it has.

  [[nodiscard]] uint64_t rows_in(uint32_t segment) const {
    for (const auto& [number, count] : rows)
      if (number == segment) return count;
    return 0;
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
            scored.code() == StatusCode::kResourceExhausted)
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
    const auto& segments = past_.store().manifest().segments;
    for (uint32_t i = 0; i < segments.size(); ++i)
      for (EntitySaliency& one : saliency_of_segment(past_.store(), segments[i])) {
        KnownSaliency& known = known_[one.entity];
        known.rows.emplace_back(i, one.times.size());
        known.all.entity = one.entity;
        known.all.times.insert(known.all.times.end(), one.times.begin(), one.times.end());
        known.all.parts.insert(known.all.parts.end(), one.parts.begin(), one.parts.end());
      }
    for (auto& [entity, known] : known_) sort_by_time(known.all);
  }

  /// The snapshots from the first one on that has no parts. Those behind it may be told differently
  /// by it. What is there moves to the segments in which the snapshots are now.
  Status score(const MemoryId& entity) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entries, entries_of(past_.store(), entity));
    const KnownSaliency& known = known_[entity];
    const auto rows = rows_by_segment(entries);
    const bool is_done = std::ranges::all_of(
        rows, [&](const auto& each) { return known.rows_in(each.first) >= each.second; });
    if (is_done) return {};
    size_t first = 0;
    for (; first < entries.size() && first < known.all.times.size() &&
           entries[first].time == known.all.times[first];
         ++first) {
      const auto segment = segment_of_code(entries[first]);
      if (segment && known.rows_in(*segment) < rows.at(*segment))
        pending_.add(entity, entries[first], known.all.parts[first]);
    }
    if (first == entries.size()) return {};
    if (!units_) {
      ENGRAM_ASSIGN_OR_RETURN(units_, measure_units(past_, entities_beside(past_.store(), entity)));
    }
    const uint64_t before = report.snapshots;
    const auto take = [&](const SnapshotEntry& entry, const StoredParts& parts) -> Status {
      pending_.add(entity, entry, parts);
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
  std::map<MemoryId, KnownSaliency> known_;  ///< 20 bytes for each snapshot.
  std::optional<MemberUnits> units_;         ///< Of the provider segment at hand.
};

/// Learns weights from what was read.
Result<SaliencyWeights> learn_from_reads(StoreReader& store) {
  const AccessTable accesses = read_accesses(store.path());
  WeightLearner learner;
  for (const auto& [entity, snapshots] : accesses.all()) {
    if (!store.has(entity)) continue;
    const EntitySaliency saliency = stored_saliency_of(store, entity);
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
  SaliencyJob job(*past, options, progress, stop);
  ENGRAM_RETURN_IF_ERROR(job.run());
  ENGRAM_ASSIGN_OR_RETURN(job.report.weights, learn_from_reads(past->store()));
  return job.report;
}

}  // namespace engram::ltm
