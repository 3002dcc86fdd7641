// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_source.h"

#include <algorithm>

#include "ltm/memory/links.h"

namespace engram::ltm {

namespace {

template <typename T>
double most_confident(const std::vector<T>& instances) {
  double max = 0;
  for (const T& instance : instances)
    max = std::max(max, static_cast<double>(instance.metadata.confidence));
  return max;
}

/// Adds the targets of the links in `found` that are snapshots.
void add_snapshots(const std::vector<Link>& found, std::vector<MemoryId>& ids) {
  for (const Link& link : found)
    if (link.id.time()) ids.push_back(link.id.entity().at(*link.id.time()));
}

}  // namespace

Status ForgetSource::check_stop() const {
  return stop_.stop_requested() ? cancelled("the plan was stopped; nothing was changed") : Status();
}

const SaliencyTable& ForgetSource::saliency() {
  if (!saliency_) saliency_ = SaliencyTable::read(store(), accesses_);
  return *saliency_;
}

SaliencyCut ForgetSource::saliency_cut(const EntityPattern& match, double share) {
  const auto [known, is_new] = cuts_.try_emplace({match.to_string(), share});
  if (is_new) known->second = saliency().cut_for(match, share);
  return known->second;
}

Result<double> ForgetSource::confidence(const MemoryId& entity, const SnapshotEntry& entry) {
  ENGRAM_RETURN_IF_ERROR(check_stop());
  if (!entry.recorded) {
    ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot latents, store().read_latent(entity, entry));
    return most_confident(latents.instances);
  }
  ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, store().read_packed(entity, entry));
  return most_confident(packed.instances);
}

Result<Snapshot> ForgetSource::read(const MemoryId& entity, const SnapshotEntry& entry) {
  ENGRAM_RETURN_IF_ERROR(check_stop());
  if (entry.recorded) return store().read_recorded(entity, entry);
  ENGRAM_ASSIGN_OR_RETURN(const QueryResult answer,
                          recall_.query(Query::of_entity(entity, select::At{entry.time})));
  const SnapshotResult* found = answer.find_snapshot(entity.at(entry.time));
  ENGRAM_CHECK(found != nullptr, "'{}' was listed", entity.at(entry.time).to_string());
  Snapshot snapshot{entity, entry.time, {}};
  for (const InstanceResult& instance : found->instances)
    snapshot.instances.push_back({instance.data, instance.metadata});
  return snapshot;
}

Result<std::vector<MemoryId>> ForgetSource::links(const MemoryId& entity,
                                                  const SnapshotEntry& entry) {
  ENGRAM_RETURN_IF_ERROR(check_stop());
  std::vector<MemoryId> ids;
  if (!entry.recorded) {
    ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot latents, store().read_latent(entity, entry));
    for (const LatentInstance& instance : latents.instances)
      add_snapshots(find_links(instance.latent.remainder), ids);
    return ids;
  }
  ENGRAM_ASSIGN_OR_RETURN(const Snapshot snapshot, store().read_recorded(entity, entry));
  const idf::Type* type = store().manifest().types.of_entity(entity);
  for (const Instance& instance : snapshot.instances) {
    // Guessed links count too: texts may be links even if their type does not say so.
    add_snapshots(find_links(instance.data), ids);
    if (type != nullptr) add_snapshots(find_links(instance.data, *type), ids);
  }
  return ids;
}

}  // namespace engram::ltm
