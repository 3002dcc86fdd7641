// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/saliency_table.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/log.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

/// Puts times in order. Of equal ones the last that was added stays.
template <typename Value>
void sort_by_time(std::vector<Time>& times, std::vector<Value>& values) {
  const auto is_later = [](Time a, Time b) { return a >= b; };
  if (std::ranges::adjacent_find(times, is_later) == times.end()) return;
  std::map<Time, Value> sorted;
  for (size_t i = 0; i < times.size(); ++i) sorted[times[i]] = values[i];
  times.clear();
  values.clear();
  for (const auto& [time, value] : sorted) {
    times.push_back(time);
    values.push_back(value);
  }
}

}  // namespace

SegmentSaliency saliency_of_segment(StoreReader& store, const SegmentInfo& segment) {
  const auto bytes = read_segment_index(store.path(), segment, kSaliencyIndex);
  if (!bytes.ok()) return {};
  auto saliency = unpack_saliency(bytes->bytes());
  if (saliency.ok()) return *std::move(saliency);
  log::warning("store '{}': index of '{}': {}", store.path().string(), segment.file,
               saliency.status().message());
  return {};
}

void sort_by_time(EntitySaliency& saliency) {
  sort_by_time(saliency.times, saliency.parts);
}

bool SaliencyCut::takes(double saliency, Time time) const {
  if (saliency != below) return saliency < below;
  // The middle bits of a product mix all bits of the time (Knuth's multiplicative hash).
  const uint64_t mixed = static_cast<uint64_t>(to_ns(time)) * 0x9e3779b97f4a7c15ULL;
  return static_cast<double>(mixed >> 32) < share_of_equal * 4294967296.0;
}

SaliencyWeights stored_weights(const std::filesystem::path& store) {
  const auto bytes = read_entity_index(store, weights_entity(), kWeightsIndex);
  if (!bytes.ok()) return SaliencyWeights::standard();
  const auto weights = unpack_weights(bytes->bytes());
  return weights.ok() ? *weights : SaliencyWeights::standard();
}

EntitySaliency stored_saliency_of(StoreReader& store, const MemoryId& entity) {
  EntitySaliency all{entity, {}, {}};
  for (const SegmentInfo& segment : store.manifest().segments) {
    if (segment.find(entity) == nullptr) continue;
    for (const EntitySaliency& one : saliency_of_segment(store, segment)) {
      if (one.entity != entity) continue;
      all.times.insert(all.times.end(), one.times.begin(), one.times.end());
      all.parts.insert(all.parts.end(), one.parts.begin(), one.parts.end());
    }
  }
  sort_by_time(all);
  return all;
}

SaliencyTable SaliencyTable::read(StoreReader& store, const AccessTable& accesses) {
  SaliencyTable table;
  const SaliencyWeights weights = stored_weights(store.path());
  for (const SegmentInfo& segment : store.manifest().segments)
    for (const EntitySaliency& one : saliency_of_segment(store, segment)) {
      Scores& scores = table.entities_[one.entity];
      for (size_t i = 0; i < one.times.size(); ++i) {
        const uint64_t reads = accesses.find(one.entity, one.times[i]).count;
        scores.times.push_back(one.times[i]);
        scores.values.push_back(
            static_cast<float>(saliency_of(parts_of(one.parts[i], reads), weights)));
      }
    }
  for (auto& [entity, scores] : table.entities_) sort_by_time(scores.times, scores.values);
  return table;
}

std::optional<double> SaliencyTable::find(const MemoryId& entity, Time time) const {
  const auto found = entities_.find(entity);
  if (found == entities_.end()) return std::nullopt;
  const auto at = std::ranges::lower_bound(found->second.times, time);
  if (at == found->second.times.end() || *at != time) return std::nullopt;
  return found->second.values[static_cast<size_t>(at - found->second.times.begin())];
}

size_t SaliencyTable::size() const {
  size_t count = 0;
  for (const auto& [entity, scores] : entities_) count += scores.times.size();
  return count;
}

SaliencyCut SaliencyTable::cut_for(const EntityPattern& match, double share) const {
  std::vector<float> values;
  for (const auto& [entity, scores] : entities_)
    if (match.matches(entity))
      values.insert(values.end(), scores.values.begin(), scores.values.end());
  const auto stays = static_cast<size_t>(std::ceil(share * static_cast<double>(values.size())));
  if (stays >= values.size()) return {};
  const size_t goes = values.size() - stays;
  const auto at = values.begin() + static_cast<ptrdiff_t>(goes - 1);
  std::ranges::nth_element(values, at);
  const float limit = *at;
  const auto below = std::ranges::count_if(values, [limit](float each) { return each < limit; });
  const auto equal = std::ranges::count(values, limit);
  return {limit,
          (static_cast<double>(goes) - static_cast<double>(below)) / static_cast<double>(equal)};
}

}  // namespace engram::ltm
