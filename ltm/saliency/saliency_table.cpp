// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/saliency_table.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/log.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {}  // namespace

SegmentSaliency saliency_of_segment(StoreReader& store, const SegmentInfo& segment) {
  const auto bytes = read_segment_index(store.path(), segment, kSaliencyIndex);
  if (!bytes.ok()) return {};
  auto saliency = unpack_saliency(bytes->bytes());
  if (saliency.ok()) return *std::move(saliency);
  log::warning("store '{}': index of '{}': {}", store.path().string(), segment.file,
               saliency.status().message());
  return {};
}

void for_each_saliency(StoreReader& store,
                       const std::function<void(uint32_t segment, EntitySaliency one)>& take) {
  const auto& segments = store.manifest().segments;
  for (uint32_t i = 0; i < segments.size(); ++i)
    for (EntitySaliency& one : saliency_of_segment(store, segments[i])) take(i, std::move(one));
}

std::map<MemoryId, EntitySaliency> all_saliency(StoreReader& store) {
  std::map<MemoryId, EntitySaliency> all;
  for_each_saliency(store, [&all](uint32_t /*segment*/, EntitySaliency one) {
    const auto [there, is_new] = all.try_emplace(one.entity);
    if (is_new)
      there->second = std::move(one);
    else
      there->second.append(one);
  });
  for (auto& [entity, one] : all) sort_by_time(one);
  return all;
}

void sort_by_time(EntitySaliency& saliency) {
  const auto is_later = [](Time a, Time b) { return a >= b; };
  if (std::ranges::adjacent_find(saliency.times, is_later) == saliency.times.end()) return;
  std::map<Time, SaliencyRow> sorted;
  for (size_t i = 0; i < saliency.times.size(); ++i) sorted[saliency.times[i]] = saliency.rows[i];
  saliency.times.clear();
  saliency.rows.clear();
  for (const auto& [time, row] : sorted) saliency.append(time, row);
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
      if (one.entity == entity) all.append(one);
    }
  }
  sort_by_time(all);
  return all;
}

SaliencyTable SaliencyTable::read(StoreReader& store, const AccessTable& accesses) {
  SaliencyTable table;
  const SaliencyWeights weights = stored_weights(store.path());
  for_each_saliency(store, [&](uint32_t /*segment*/, const EntitySaliency& one) {
    std::vector<Score>& scores = table.entities_[one.entity];
    for (size_t i = 0; i < one.times.size(); ++i) {
      const SaliencyRow& row = one.rows[i];
      if (row.state != RowState::kKnown) continue;
      const uint64_t reads = accesses.find(one.entity, one.times[i]).count;
      scores.push_back({one.times[i],
                        static_cast<float>(saliency_of(parts_of(row.parts, reads), weights)),
                        row.stands_for});
    }
  });
  for (auto& [entity, scores] : table.entities_) {
    std::ranges::stable_sort(scores, {}, &Score::time);
    // Of equal times the last one stays, so the first ones go from behind.
    const auto gone = std::unique(scores.rbegin(), scores.rend(),
                                  [](const Score& a, const Score& b) { return a.time == b.time; });
    scores.erase(scores.begin(), gone.base());
  }
  return table;
}

std::optional<double> SaliencyTable::find(const MemoryId& entity, Time time) const {
  const auto found = entities_.find(entity);
  if (found == entities_.end()) return std::nullopt;
  const auto at = std::ranges::lower_bound(found->second, time, {}, &Score::time);
  if (at == found->second.end() || at->time != time) return std::nullopt;
  return at->value;
}

size_t SaliencyTable::size() const {
  size_t count = 0;
  for (const auto& [entity, scores] : entities_) count += scores.size();
  return count;
}

SaliencyCut SaliencyTable::cut_for(const EntityPattern& match, double share) const {
  std::vector<float> values;
  uint64_t all = 0;
  for (const auto& [entity, scores] : entities_) {
    if (!match.matches(entity)) continue;
    for (const Score& score : scores) {
      values.push_back(score.value);
      all += score.stands_for;
    }
  }
  const auto stays = static_cast<size_t>(std::ceil(share * static_cast<double>(all)));
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
