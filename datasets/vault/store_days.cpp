// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/store_days.h"

#include <algorithm>
#include <optional>
#include <set>
#include <variant>

#include "datasets/recordings/merged_snapshots.h"
#include "ltm/forgetting/redacted_days.h"
#include "ltm/store/checksum.h"

namespace engram::datasets::vault {

namespace {

/// What a snapshot's place is made of. No padding, since its bytes are summed.
struct PlaceSum {
  uint64_t before;
  int64_t time;
  uint64_t file;
  uint64_t at;
  uint64_t rows;
  uint64_t is_latent;
};
static_assert(sizeof(PlaceSum) == 6 * sizeof(uint64_t));

uint64_t sum_of(const PlaceSum& place) {
  return ltm::checksum(std::as_bytes(std::span(&place, 1)));
}

class DayLister {
 public:
  DayLister(ltm::Recall& recall, const ltm::Query& query, ltm::Prefer prefer,
            ltm::RedactedDays redacted, const std::stop_token& stop)
      : recall_(recall),
        query_(query),
        prefer_(prefer),
        redacted_(std::move(redacted)),
        stop_(stop) {
    const ltm::Manifest& manifest = recall.store().manifest();
    store_ = ltm::checksum(as_bytes(manifest.store_id));
    // A place in a journal counts in one generation alone: sealing ends it.
    journals_ = store_ ^ (manifest.generation + 1);
    for (const ltm::SegmentInfo& segment : manifest.segments)
      segments_.push_back(ltm::checksum(as_bytes(segment.file)) ^ segment.checksum ^ store_);
  }

  Status add(const ltm::MemoryId& entity) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall_.store().timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(const auto wanted, wanted_days(entity, *timeline));
    std::optional<StoreDay> open;
    const auto close = [&] {
      if (open && (!wanted || wanted->contains(open->day))) {
        mark_redactions(*open);
        days_.push_back(*open);
      }
      open.reset();
    };
    ENGRAM_RETURN_IF_ERROR(timeline->for_each([&](const ltm::SnapshotEntry& entry) -> Status {
      if (stop_.stop_requested()) return cancelled("export was stopped");
      const Day day = day_of(entry.time);
      if (open && open->day != day) close();
      if (!open) open = StoreDay{entity, day, 0, 0, 0, 0};
      ++open->snapshots;
      open->source = place_of(open->source, entry);
      open->times = sum_of({open->times, to_ns(entry.time), 0, 0, 0, 0});
      open->latents_only += entry.recorded ? 0 : 1;
      return {};
    }));
    close();
    return {};
  }

  std::vector<StoreDay> take() { return std::move(days_); }

 private:
  /// Nothing if all days are wanted.
  Result<std::optional<std::set<Day>>> wanted_days(const ltm::MemoryId& entity,
                                                   ltm::Timeline& timeline) {
    if (selects_all(query_, entity)) return std::optional<std::set<Day>>();
    std::set<Day> days;
    ENGRAM_ASSIGN_OR_RETURN(SnapshotCursor cursor,
                            SnapshotCursor::create(timeline, query_.snapshots_of(entity),
                                                   recall_.listed(entity, false)));
    while (true) {
      if (stop_.stop_requested()) return cancelled("export was stopped");
      ENGRAM_ASSIGN_OR_RETURN(const auto step, cursor.next());
      if (!step) return std::optional(std::move(days));
      if (!step->is_future) days.insert(day_of(step->entry.time));
    }
  }

  /// A day without any keeps the mark of its times alone.
  void mark_redactions(StoreDay& day) const {
    const auto of_entity = redacted_.find(day.entity);
    if (of_entity == redacted_.end()) return;
    const auto mark = of_entity->second.find(ltm::redacted_day(day_begin(day.day)));
    if (mark != of_entity->second.end()) day.times = sum_of({day.times, 0, mark->second, 0, 0, 0});
  }

  [[nodiscard]] uint64_t place_of(uint64_t before, const ltm::SnapshotEntry& entry) const {
    const bool is_latent = entry.latent && (!entry.recorded || prefer_ == ltm::Prefer::kLatent);
    const ltm::SnapshotEntry::Location& at = is_latent ? *entry.latent : *entry.recorded;
    const uint64_t file = at.rows == 0 ? journals_ ^ (at.source + 1) : segments_.at(at.source);
    return sum_of({before, to_ns(entry.time), file, at.at, at.rows, is_latent ? 1U : 0U});
  }

  ltm::Recall& recall_;
  const ltm::Query& query_;
  ltm::Prefer prefer_;
  ltm::RedactedDays redacted_;
  const std::stop_token& stop_;
  uint64_t store_ = 0;
  uint64_t journals_ = 0;
  std::vector<uint64_t> segments_;
  std::vector<StoreDay> days_;
};

}  // namespace

bool selects_all(const ltm::Query& query, const ltm::MemoryId& entity) {
  return std::ranges::any_of(query.snapshots_of(entity), [](const ltm::SnapshotQuery& each) {
    return std::holds_alternative<ltm::select::All>(each.selector) && each.conditions.empty();
  });
}

Result<std::vector<StoreDay>> days_of_store(ltm::Recall& recall, const ltm::Query& query,
                                            ltm::Prefer prefer, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, exported_entities(recall, query));
  ENGRAM_ASSIGN_OR_RETURN(auto redacted, ltm::read_redacted_days(recall.store().path()));
  DayLister lister(recall, query, prefer, std::move(redacted), stop);
  for (const ltm::MemoryId& entity : entities) ENGRAM_RETURN_IF_ERROR(lister.add(entity));
  return lister.take();
}

}  // namespace engram::datasets::vault
