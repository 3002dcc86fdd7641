// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/episode_rows.h"

#include <algorithm>

namespace engram::datasets {

namespace {

/// Counts the values of each entity before `end`.
Result<std::vector<uint64_t>> count_values(EpisodeCursors& cursors, size_t entities, Time end) {
  std::vector<uint64_t> counts(entities, 0);
  for (size_t i = 0; i < entities; ++i)
    for (; cursors.peek(i, end); ++counts[i]) ENGRAM_RETURN_IF_ERROR(cursors.advance(i));
  return counts;
}

/// Returns, for each entity, whether it has one value at each of the first steps of `leader` and no
/// other value.
Result<std::vector<bool>> are_in_step(EpisodeCursors& cursors, size_t entities, size_t leader,
                                      Time end) {
  std::vector<bool> fits(entities, true);
  std::vector<bool> has_ended(entities, false);
  while (const auto step = cursors.peek(leader, end)) {
    for (size_t i = 0; i < entities; ++i) {
      auto found = cursors.peek(i, end);
      for (; found && found->entry.time < step->entry.time; found = cursors.peek(i, end)) {
        fits[i] = false;
        ENGRAM_RETURN_IF_ERROR(cursors.advance(i));
      }
      const bool is_there = found && found->entry.time == step->entry.time;
      // An array has no gaps, so an entity may end early but must not start again.
      if (is_there && has_ended[i]) fits[i] = false;
      has_ended[i] = !is_there;
      if (is_there && i != leader) ENGRAM_RETURN_IF_ERROR(cursors.advance(i));
    }
    ENGRAM_RETURN_IF_ERROR(cursors.advance(leader));
  }
  for (size_t i = 0; i < entities; ++i)
    for (; cursors.peek(i, end); fits[i] = false) ENGRAM_RETURN_IF_ERROR(cursors.advance(i));
  return fits;
}

}  // namespace

Result<EpisodeCursors> EpisodeCursors::create(ltm::Recall& recall, const ltm::Query& query,
                                              const std::vector<ExportedEntity>& entities) {
  EpisodeCursors cursors;
  for (size_t i = 0; i < entities.size(); ++i) {
    const ltm::MemoryId& entity = entities[i].entity;
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall.store().timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(SnapshotCursor snapshots,
                            SnapshotCursor::create(*timeline, query.snapshots_of(entity),
                                                   recall.listed(entity, false)));
    cursors.cursors_.push_back({std::move(snapshots), std::nullopt});
    ENGRAM_RETURN_IF_ERROR(cursors.advance(i));
  }
  return cursors;
}

std::optional<SnapshotCursor::Step> EpisodeCursors::peek(size_t entity, Time end) const {
  const auto& step = cursors_[entity].step;
  return step && step->entry.time < end ? step : std::nullopt;
}

Status EpisodeCursors::advance(size_t entity) {
  Cursor& cursor = cursors_[entity];
  ENGRAM_ASSIGN_OR_RETURN(cursor.step, cursor.snapshots.next());
  if (cursor.step && cursor.step->is_future) cursor.step.reset();
  return {};
}

Result<std::vector<EpisodeRows>> plan_episodes(ltm::Recall& recall, const ltm::Query& query,
                                               const std::vector<ExportedEntity>& entities,
                                               const Dialect& dialect, NotHeld& not_held) {
  ENGRAM_ASSIGN_OR_RETURN(const auto episodes, stored_episodes(recall, dialect));
  // Two passes with their own cursors: the entity with the largest number of values in an episode
  // must be known before the others are compared with it.
  ENGRAM_ASSIGN_OR_RETURN(auto counted, EpisodeCursors::create(recall, query, entities));
  ENGRAM_ASSIGN_OR_RETURN(auto compared, EpisodeCursors::create(recall, query, entities));
  const size_t count = entities.size();
  std::vector<bool> is_early(count, false);
  std::vector<bool> is_out_of_step(count, false);
  for (size_t i = 0; i < count; ++i)
    for (; counted.peek(i, episodes.front().start); is_early[i] = true) {
      ENGRAM_RETURN_IF_ERROR(counted.advance(i));
      ENGRAM_RETURN_IF_ERROR(compared.advance(i));
    }
  std::vector<EpisodeRows> plan;
  for (size_t e = 0; e < episodes.size(); ++e) {
    const Time end = e + 1 < episodes.size() ? episodes[e + 1].start : Time::max();
    EpisodeRows one{episodes[e], end, {}, 0};
    ENGRAM_ASSIGN_OR_RETURN(one.rows, count_values(counted, count, end));
    const auto longest = std::ranges::max_element(one.rows);
    if (longest == one.rows.end() || *longest == 0) continue;
    one.longest = *longest;
    const auto leader = static_cast<size_t>(longest - one.rows.begin());
    ENGRAM_ASSIGN_OR_RETURN(const auto fits, are_in_step(compared, count, leader, end));
    for (size_t i = 0; i < count; ++i)
      if (!fits[i] && one.rows[i] > 0) {
        one.rows[i] = 0;
        is_out_of_step[i] = true;
      }
    plan.push_back(std::move(one));
  }
  for (size_t i = 0; i < count; ++i) {
    if (is_early[i]) ++not_held["values before the first episode"];
    if (is_out_of_step[i]) ++not_held["values that do not come one per step"];
  }
  return plan;
}

}  // namespace engram::datasets
