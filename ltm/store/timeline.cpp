// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/timeline.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace engram::ltm {

namespace {

std::optional<Time> next_ns(Time time) {
  if (to_ns(time) == std::numeric_limits<int64_t>::max()) return std::nullopt;
  return time_from_ns(to_ns(time) + 1);
}

}  // namespace

Timeline::Timeline(MemoryId entity, std::vector<TimelinePart> parts,
                   std::vector<SnapshotEntry> journal, OpenSegment open)
    : entity_(std::move(entity)),
      parts_(std::move(parts)),
      journal_(std::move(journal)),
      open_(std::move(open)),
      hints_(parts_.size()) {
  make_clusters();
}

Time Timeline::first_of(size_t part) const {
  return is_journal(part) ? journal_.front().time : parts_[part].first;
}

Time Timeline::last_of(size_t part) const {
  return is_journal(part) ? journal_.back().time : parts_[part].last;
}

void Timeline::make_clusters() {
  std::vector<size_t> order(part_count());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [this](size_t part) { return first_of(part); });
  for (const size_t part : order) {
    if (clusters_.empty() || clusters_.back().last < first_of(part))
      clusters_.push_back({first_of(part), last_of(part), {}, {}});
    clusters_.back().parts.push_back(part);
    clusters_.back().last = std::max(clusters_.back().last, last_of(part));
  }
}

Result<SegmentReader*> Timeline::open(size_t part) {
  return open_(parts_[part].segment);
}

std::optional<Time> Timeline::first() const {
  return clusters_.empty() ? std::nullopt : std::optional(clusters_.front().first);
}

std::optional<Time> Timeline::last() const {
  return clusters_.empty() ? std::nullopt : std::optional(clusters_.back().last);
}

Result<std::optional<RowSpan>> Timeline::span_at_or_after(size_t part, Time time) {
  ENGRAM_ASSIGN_OR_RETURN(SegmentReader * reader, open(part));
  RowSpan& hint = hints_[part];
  // Most queries continue where the previous one ended.
  if (hint.rows > 0 && hint.time == time) return std::optional(hint);
  std::optional<RowSpan> found;
  if (hint.rows > 0 && hint.time < time) {
    ENGRAM_ASSIGN_OR_RETURN(found, reader->snapshot_at(entity_, hint.first + hint.rows));
  }
  if (!found || found->time < time) {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t row, reader->lower_bound(entity_, time));
    ENGRAM_ASSIGN_OR_RETURN(found, reader->snapshot_at(entity_, row));
  }
  if (found) hint = *found;
  return found;
}

Result<std::optional<Time>> Timeline::part_at_or_after(size_t part, Time time) {
  if (last_of(part) < time) return std::optional<Time>();
  if (first_of(part) >= time) return std::optional(first_of(part));
  if (is_journal(part))
    return std::optional(std::ranges::lower_bound(journal_, time, {}, &SnapshotEntry::time)->time);
  ENGRAM_ASSIGN_OR_RETURN(const auto span, span_at_or_after(part, time));
  return span ? std::optional(span->time) : std::nullopt;
}

Result<std::optional<Time>> Timeline::part_at_or_before(size_t part, Time time) {
  if (first_of(part) > time) return std::optional<Time>();
  if (last_of(part) <= time) return std::optional(last_of(part));
  if (is_journal(part))
    return std::optional(
        std::prev(std::ranges::upper_bound(journal_, time, {}, &SnapshotEntry::time))->time);
  ENGRAM_ASSIGN_OR_RETURN(SegmentReader * reader, open(part));
  // The part continues after `time`, so the next nanosecond exists.
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t row, reader->lower_bound(entity_, *next_ns(time)));
  if (row == 0) return std::optional<Time>();
  ENGRAM_ASSIGN_OR_RETURN(const auto span, reader->snapshot_at(entity_, row - 1));
  return span ? std::optional(span->time) : std::nullopt;
}

Status Timeline::add_entry(size_t part, SnapshotEntry& entry) {
  if (is_journal(part)) {
    const auto found = std::ranges::lower_bound(journal_, entry.time, {}, &SnapshotEntry::time);
    if (found != journal_.end() && found->time == entry.time) entry.put(false, *found->recorded);
    return {};
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto span, span_at_or_after(part, entry.time));
  if (!span || span->time != entry.time) return {};
  entry.put(parts_[part].is_latent, {parts_[part].segment, span->rows, span->first});
  return {};
}

Result<std::optional<SnapshotEntry>> Timeline::entry_at(std::optional<Time> time) {
  if (!time) return std::optional<SnapshotEntry>();
  SnapshotEntry entry;
  entry.time = *time;
  for (size_t part = 0; part < part_count(); ++part)
    if (first_of(part) <= *time && *time <= last_of(part))
      ENGRAM_RETURN_IF_ERROR(add_entry(part, entry));
  if (!entry.recorded && !entry.latent)
    return data_loss("entity '{}': the manifest tells of a snapshot at {} that no segment has",
                     entity_.to_string(), to_string(*time));
  return std::optional(entry);
}

Result<std::optional<SnapshotEntry>> Timeline::at_or_after(Time time) {
  std::optional<Time> best;
  for (size_t part = 0; part < part_count(); ++part) {
    if (best && first_of(part) >= *best) continue;
    ENGRAM_ASSIGN_OR_RETURN(const std::optional<Time> found, part_at_or_after(part, time));
    if (found && (!best || *found < *best)) best = found;
  }
  return entry_at(best);
}

Result<std::optional<SnapshotEntry>> Timeline::at_or_before(Time time) {
  std::optional<Time> best;
  for (size_t part = part_count(); part-- > 0;) {
    if (best && last_of(part) <= *best) continue;
    ENGRAM_ASSIGN_OR_RETURN(const std::optional<Time> found, part_at_or_before(part, time));
    if (found && (!best || *found > *best)) best = found;
  }
  return entry_at(best);
}

Status Timeline::visit_part(size_t part, Time first, Time last, const Visit& visit) {
  if (is_journal(part)) {
    auto entry = std::ranges::lower_bound(journal_, first, {}, &SnapshotEntry::time);
    for (; entry != journal_.end() && entry->time <= last; ++entry)
      ENGRAM_RETURN_IF_ERROR(visit(*entry));
    return {};
  }
  ENGRAM_ASSIGN_OR_RETURN(auto span, span_at_or_after(part, first));
  while (span && span->time <= last) {
    SnapshotEntry entry;
    entry.time = span->time;
    entry.put(parts_[part].is_latent, {parts_[part].segment, span->rows, span->first});
    ENGRAM_RETURN_IF_ERROR(visit(entry));
    // A visit may have opened so many other segments that this one was closed.
    ENGRAM_ASSIGN_OR_RETURN(SegmentReader * reader, open(part));
    ENGRAM_ASSIGN_OR_RETURN(span, reader->snapshot_at(entity_, span->first + span->rows));
  }
  return {};
}

Status Timeline::for_each(Time first, Time last, const Visit& visit) {
  for (const Cluster& cluster : clusters_) {
    if (cluster.last < first || cluster.first > last) continue;
    const Time end = std::min(last, cluster.last);
    std::optional<Time> from = std::max(first, cluster.first);
    if (cluster.parts.size() == 1) {
      ENGRAM_RETURN_IF_ERROR(visit_part(cluster.parts.front(), *from, end, visit));
      continue;
    }
    while (from) {
      ENGRAM_ASSIGN_OR_RETURN(const auto entry, at_or_after(*from));
      if (!entry || entry->time > end) break;
      ENGRAM_RETURN_IF_ERROR(visit(*entry));
      from = next_ns(entry->time);
    }
  }
  return {};
}

Result<uint64_t> Timeline::count_of(Cluster& cluster) {
  if (cluster.count) return *cluster.count;
  if (cluster.parts.size() == 1) {
    const size_t part = cluster.parts.front();
    return is_journal(part) ? journal_.size() : parts_[part].snapshots;
  }
  uint64_t counted = 0;
  ENGRAM_RETURN_IF_ERROR(for_each(cluster.first, cluster.last, [&](const SnapshotEntry&) {
    ++counted;
    return Status();
  }));
  cluster.count = counted;
  return counted;
}

Result<uint64_t> Timeline::count() {
  uint64_t total = 0;
  for (Cluster& cluster : clusters_) {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, count_of(cluster));
    total += count;
  }
  return total;
}

Result<std::optional<SnapshotEntry>> Timeline::nth_of(const Cluster& cluster, uint64_t index) {
  const size_t part = cluster.parts.front();
  if (cluster.parts.size() == 1 && is_journal(part)) return std::optional(journal_[index]);
  if (cluster.parts.size() == 1 && parts_[part].rows == parts_[part].snapshots) {
    ENGRAM_ASSIGN_OR_RETURN(SegmentReader * reader, open(part));
    ENGRAM_ASSIGN_OR_RETURN(const auto span, reader->snapshot_at(entity_, index));
    return entry_at(span ? std::optional(span->time) : std::nullopt);
  }
  Time from = cluster.first;
  for (;; --index) {
    ENGRAM_ASSIGN_OR_RETURN(auto entry, at_or_after(from));
    const std::optional<Time> next = entry ? next_ns(entry->time) : std::nullopt;
    if (index == 0 || !next) return entry;
    from = *next;
  }
}

Result<std::optional<SnapshotEntry>> Timeline::nth(uint64_t index) {
  for (Cluster& cluster : clusters_) {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, count_of(cluster));
    if (index < count) return nth_of(cluster, index);
    index -= count;
  }
  return std::optional<SnapshotEntry>();
}

}  // namespace engram::ltm
