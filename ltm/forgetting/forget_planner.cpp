// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_planner.h"

#include <algorithm>
#include <tuple>

#include "ltm/filter/saturated_time.h"

namespace engram::ltm {

namespace {

/// Number of snapshots that policies get at a time. It bounds the memory for their entries.
constexpr size_t kPartSnapshots = 1 << 16;

/// Bytes by which the manifest may grow, because it counts what was forgotten.
constexpr uint64_t kManifestBytes = 4096;
constexpr uint64_t kManifestBytesPerEntity = 256;

}  // namespace

Status ForgetPlanner::check_stop(const std::string& what, size_t done) {
  if (context_.progress) context_.progress({what, done, entities_.size(), "", -1});
  return context_.stop.stop_requested() ? cancelled("the plan was stopped; nothing was changed")
                                        : Status();
}

uint16_t ForgetPlanner::reason_number(const std::string& reason) {
  const auto known = std::ranges::find(reasons_, reason);
  if (known != reasons_.end()) return static_cast<uint16_t>(known - reasons_.begin());
  reasons_.push_back(reason);
  ENGRAM_CHECK(reasons_.size() <= UINT16_MAX, "{} reasons", reasons_.size());
  return static_cast<uint16_t>(reasons_.size() - 1);
}

bool ForgetPlanner::may_go(const Entity& entity, size_t snapshot) const {
  return entity.reason[snapshot] == kStays && !entity.is_protected[snapshot] &&
         entity.places[snapshot].is_sealed();
}

Status ForgetPlanner::load(bool is_explicit) {
  const Time young = protection_.younger_than
                         ? saturated_add(context_.now, -*protection_.younger_than)
                         : Time::max();
  for (const MemoryId& id : source_.store().entities()) {
    Entity entity{id, {}, {}, {}, {}, {}, 0, 0};
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, source_.store().timeline(id));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t total, timeline->count());
    entity.times.reserve(total);
    entity.places.reserve(total);
    ENGRAM_RETURN_IF_ERROR(timeline->for_each([&entity](const SnapshotEntry& entry) {
      entity.times.push_back(entry.time);
      entity.places.push_back(SnapshotPlaces::of(entry));
      return Status();
    }));
    const size_t count = entity.times.size();
    const bool is_named = std::ranges::any_of(
        protection_.entities, [&id](const EntityPattern& pattern) { return pattern.matches(id); });
    entity.reason.assign(count, kStays);
    entity.is_protected.assign(count, is_named);
    for (size_t i = 0; i < count; ++i) {
      entity.unsealed += entity.places[i].is_sealed() ? 0 : 1;
      const bool is_new = count - i <= protection_.newest || entity.times[i] > young;
      if (is_new && !is_explicit) entity.is_protected[i] = true;
    }
    entities_.push_back(std::move(entity));
  }
  return {};
}

Result<std::vector<ForgetProposal>> ForgetPlanner::propose(
    ForgetSource& source, const std::vector<std::unique_ptr<ForgetPolicy>>& policies,
    const MemoryId& id, std::span<const SnapshotEntry> snapshots, std::vector<bool> allowed) {
  std::vector<ForgetProposal> proposals;
  for (const auto& policy : policies) {
    ENGRAM_ASSIGN_OR_RETURN(proposals, policy->propose(source, {id, snapshots, allowed}));
    std::vector<bool> narrowed(allowed.size(), false);
    for (const ForgetProposal& proposal : proposals) {
      ENGRAM_CHECK(allowed.at(proposal.snapshot), "'{}' proposed what may not go",
                   policy->reason());
      narrowed[proposal.snapshot] = true;
    }
    allowed = std::move(narrowed);
  }
  return proposals;
}

Status ForgetPlanner::ask(const ForgetRule& rule, const Entity& entity,
                          const std::vector<bool>& is_queued,
                          const std::function<void(const ForgetProposal&)>& take) {
  ENGRAM_ASSIGN_OR_RETURN(const auto policies, rule.policies(context_.now));
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, source_.store().timeline(entity.id));
  std::vector<SnapshotEntry> seen;
  std::vector<size_t> index_of;
  std::vector<bool> allowed;
  const auto ask_part = [&]() -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const auto proposals,
                            propose(source_, policies, entity.id, seen, allowed));
    for (const auto& [snapshot, order] : proposals) take({index_of[snapshot], order});
    seen.clear();
    index_of.clear();
    allowed.clear();
    return {};
  };
  size_t next = 0;
  ENGRAM_RETURN_IF_ERROR(timeline->for_each([&](const SnapshotEntry& entry) -> Status {
    const size_t i = next++;
    if (entity.reason[i] != kStays || (!is_queued.empty() && is_queued[i])) return {};
    seen.push_back(entry);
    index_of.push_back(i);
    allowed.push_back(may_go(entity, i));
    return seen.size() < kPartSnapshots ? Status() : ask_part();
  }));
  return ask_part();
}

Result<uint16_t> ForgetPlanner::reason_of(const ForgetRule& rule, const std::string& prefix) {
  ENGRAM_ASSIGN_OR_RETURN(const auto policies, rule.policies(context_.now));
  std::string text;
  for (const auto& policy : policies) text += (text.empty() ? "" : ", ") + policy->reason();
  return reason_number(prefix + text);
}

Status ForgetPlanner::take_by(const ForgetRule& rule) {
  for (size_t i = 0; i < entities_.size(); ++i) {
    Entity& entity = entities_[i];
    if (!rule.match.matches(entity.id)) continue;
    ENGRAM_RETURN_IF_ERROR(check_stop("plan", i));
    ENGRAM_ASSIGN_OR_RETURN(const uint16_t reason, reason_of(rule, ""));
    std::vector<size_t> taken;
    ENGRAM_RETURN_IF_ERROR(ask(rule, entity, {}, [&taken](const ForgetProposal& proposal) {
      taken.push_back(proposal.snapshot);
    }));
    for (const size_t snapshot : taken) entity.reason[snapshot] = reason;
  }
  return {};
}

Status ForgetPlanner::take(const ForgetSet& chosen, const std::string& reason) {
  const uint16_t number = reason_number(reason);
  for (Entity& entity : entities_) {
    const auto times = chosen.find(entity.id);
    if (times == chosen.end()) continue;
    for (size_t i = 0; i < entity.times.size(); ++i) {
      if (!times->second.contains(entity.times[i])) continue;
      if (may_go(entity, i))
        entity.reason[i] = number;
      else if (entity.is_protected[i])
        ++entity.shielded;
    }
  }
  return {};
}

Result<SnapshotEntry> ForgetPlanner::entry(const Entity& entity, size_t snapshot) {
  const Time time = entity.times[snapshot];
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, source_.store().timeline(entity.id));
  ENGRAM_ASSIGN_OR_RETURN(const auto found, timeline->at_or_after(time));
  if (found && found->time == time) return *found;
  return data_loss("'{}' was there and is not", entity.id.at(time).to_string());
}

Status ForgetPlanner::follow_links(std::vector<std::pair<size_t, size_t>>& waiting) {
  while (!waiting.empty()) {
    const auto [e, s] = waiting.back();
    waiting.pop_back();
    const Entity& from = entities_[e];
    ENGRAM_ASSIGN_OR_RETURN(const SnapshotEntry place, entry(from, s));
    ENGRAM_ASSIGN_OR_RETURN(const auto links, source_.links(from.id, place));
    for (const MemoryId& link : links) {
      const auto to = std::ranges::lower_bound(entities_, link.entity(), {}, &Entity::id);
      if (to == entities_.end() || to->id != link.entity()) continue;
      const auto time = std::ranges::lower_bound(to->times, *link.time());
      if (time == to->times.end() || *time != *link.time()) continue;
      const auto i = static_cast<size_t>(time - to->times.begin());
      to->is_protected[i] = true;
      if (to->reason[i] == kStays) continue;
      // The snapshot stays now, so what it links to must stay too.
      to->reason[i] = kStays;
      ++to->shielded;
      waiting.emplace_back(static_cast<size_t>(to - entities_.begin()), i);
    }
  }
  return {};
}

Status ForgetPlanner::protect_linked() {
  std::vector<std::pair<size_t, size_t>> waiting;
  for (size_t e = 0; e < entities_.size(); ++e) {
    ENGRAM_RETURN_IF_ERROR(check_stop("look for links", e));
    const std::vector<uint16_t> before = entities_[e].reason;
    for (size_t s = 0; s < before.size(); ++s) {
      // Snapshots that are given back during this loop were followed at that moment.
      if (before[s] != kStays) continue;
      if (context_.stop.stop_requested()) return check_stop("look for links", e);
      waiting.emplace_back(e, s);
      ENGRAM_RETURN_IF_ERROR(follow_links(waiting));
    }
  }
  return {};
}

/// A segment that cannot be read counts as one with groups, as rewriting it frees nothing either.
bool ForgetPlanner::has_groups(uint32_t segment, const MemoryId& entity) {
  const auto [known, is_new] = has_groups_.try_emplace({segment, entity}, true);
  if (!is_new) return known->second;
  const auto forms = source_.store().forms(entity, segment);
  if (forms.ok()) known->second = forms->has_groups;
  return known->second;
}

FreedBytes ForgetPlanner::freed() {
  FreedBytes freed(source_.store().manifest(), [this](uint32_t segment, const MemoryId& entity) {
    return has_groups(segment, entity);
  });
  for (const Entity& entity : entities_)
    for (const SnapshotPlaces& places : entity.places) freed.count(entity.id, places);
  for (const Entity& entity : entities_)
    for (size_t i = 0; i < entity.reason.size(); ++i)
      if (entity.reason[i] != kStays) freed.take(entity.id, entity.places[i]);
  return freed;
}

uint64_t ForgetPlanner::wanted_bytes(const ForgetOptions& options) const {
  uint64_t wanted = 0;
  if (options.max_bytes && context_.store_bytes > *options.max_bytes)
    wanted = context_.store_bytes - *options.max_bytes;
  if (options.min_free_disk_bytes && context_.free_disk_bytes < *options.min_free_disk_bytes)
    wanted = std::max(wanted, *options.min_free_disk_bytes - context_.free_disk_bytes);
  return wanted == 0 ? 0 : wanted + kManifestBytes + kManifestBytesPerEntity * entities_.size();
}

Result<std::vector<ForgetPlanner::Candidate>> ForgetPlanner::candidates_of(
    const ForgetRule& rule, std::vector<std::vector<bool>>& is_queued) {
  std::vector<Candidate> candidates;
  size_t max = 0;
  for (const Entity& entity : entities_) max += entity.times.size();
  candidates.reserve(max);  // Costs no memory for pages that are never written.
  for (uint32_t e = 0; e < entities_.size(); ++e) {
    const Entity& entity = entities_[e];
    if (!rule.match.matches(entity.id)) continue;
    ENGRAM_RETURN_IF_ERROR(check_stop("plan", e));
    const size_t before = candidates.size();
    ENGRAM_RETURN_IF_ERROR(ask(rule, entity, is_queued[e], [&](const ForgetProposal& proposal) {
      candidates.push_back({proposal.order, e, static_cast<uint32_t>(proposal.snapshot)});
    }));
    for (size_t i = before; i < candidates.size(); ++i) is_queued[e][candidates[i].snapshot] = true;
  }
  std::ranges::sort(candidates, {}, [this](const Candidate& each) {
    return std::tuple(each.order, entities_[each.entity].times[each.snapshot], each.entity);
  });
  return candidates;
}

// The first round takes what is expected to suffice, and what it frees is measured: what goes too
// much cannot come back. The rest is little, so later rounds are careful, since each of them
// rewrites segments.
uint64_t ForgetPlanner::counted_bytes(const FreedBytes& going, const ForgetOptions& options) {
  return options.is_later_round ? going.careful() : going.expected();
}

Status ForgetPlanner::take_for_quota(const ForgetOptions& options) {
  const uint64_t wanted = wanted_bytes(options);
  FreedBytes going = freed();
  if (fades_for_quota_) {
    const auto faded = static_cast<uint64_t>(counted_faded_bytes(options));
    missing_bytes_ = wanted - std::min(wanted, faded);
    return {};
  }
  std::vector<std::vector<bool>> is_queued;
  for (const Entity& entity : entities_) is_queued.emplace_back(entity.reason.size(), false);
  std::vector<ForgetRule> order = options.first;
  order.emplace_back().age = AgePolicy::Options{};
  for (size_t rank = 0; rank < order.size() && counted_bytes(going, options) < wanted; ++rank) {
    ENGRAM_ASSIGN_OR_RETURN(const uint16_t reason, reason_of(order[rank], "quota: "));
    ENGRAM_ASSIGN_OR_RETURN(const auto candidates, candidates_of(order[rank], is_queued));
    for (const Candidate& each : candidates) {
      if (counted_bytes(going, options) >= wanted) break;
      Entity& entity = entities_[each.entity];
      entity.reason[each.snapshot] = reason;
      going.take(entity.id, entity.places[each.snapshot]);
    }
  }
  missing_bytes_ = wanted - std::min(wanted, counted_bytes(going, options));
  return {};
}

uint64_t ForgetPlanner::freed_model_bytes(const Entity& entity) const {
  for (size_t i = 0; i < entity.reason.size(); ++i)
    if (entity.reason[i] == kStays && entity.places[i].has_latents()) return 0;
  uint64_t bytes = 0;
  for (const ModelInfo& model : source_.store().manifest().models)
    if (model.entity == entity.id) bytes += model.bytes;
  return bytes;
}

EntityForgetPlan ForgetPlanner::plan_of(const Entity& entity, const FreedBytes& shares) const {
  EntityForgetPlan plan;
  plan.unsealed = entity.unsealed;
  plan.shielded = entity.shielded;
  double bytes = 0;
  for (size_t i = 0; i < entity.reason.size(); ++i) {
    if (entity.reason[i] == kStays) continue;
    plan.gone.insert(entity.times[i]);
    ++plan.reasons[reasons_[entity.reason[i]]];
    bytes += shares.share(entity.id, entity.places[i]);
  }
  add_fading(entity, plan);
  plan.stays = entity.reason.size() - plan.gone.size();
  plan.freed_bytes = static_cast<uint64_t>(bytes);
  if (!plan.gone.empty()) plan.freed_bytes += freed_model_bytes(entity);
  return plan;
}

ForgetPlan ForgetPlanner::finish() {
  ForgetPlan plan;
  const FreedBytes going = freed();
  plan.freed_bytes = going.expected();
  plan.store_bytes = context_.store_bytes;
  plan.free_disk_bytes = context_.free_disk_bytes;
  plan.missing_bytes = missing_bytes_;
  plan.faded_bytes = static_cast<uint64_t>(faded_bytes_);
  plan.fades_for_quota = fades_for_quota_;
  for (const Entity& entity : entities_) {
    plan.entities.emplace(entity.id, plan_of(entity, going));
    if (!plan.entities.at(entity.id).gone.empty()) plan.freed_bytes += freed_model_bytes(entity);
  }
  return plan;
}

}  // namespace engram::ltm
