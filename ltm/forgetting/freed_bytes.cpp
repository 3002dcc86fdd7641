// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/freed_bytes.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// The part of the shares in a rewritten segment that the careful estimate counts.
constexpr double kCarefulShare = 0.7;

}  // namespace

SnapshotPlaces SnapshotPlaces::of(const SnapshotEntry& entry) {
  SnapshotPlaces places;
  if (entry.recorded)
    places.recorded = entry.recorded->rows > 0 ? entry.recorded->source : kJournal;
  if (entry.latent) places.latent = entry.latent->source;
  return places;
}

FreedBytes::FreedBytes(const Manifest& manifest, HasGroups has_groups)
    : has_groups_(std::move(has_groups)) {
  segments_.resize(manifest.segments.size());
  for (size_t i = 0; i < segments_.size(); ++i) {
    const SegmentInfo& info = manifest.segments[i];
    segments_[i].bytes = info.bytes;
    segments_[i].is_recorded = info.kind == SegmentKind::kRecorded;
    for (const SegmentEntity& part : info.entities)
      if (part.snapshots > 0)
        segments_[i].parts[part.id].each =
            static_cast<double>(part.stored_bytes) / static_cast<double>(part.snapshots);
  }
}

void FreedBytes::count_in(uint32_t segment, const MemoryId& entity) {
  ++segments_[segment].left;
  ++segments_[segment].parts[entity].left;
}

void FreedBytes::count(const MemoryId& entity, const SnapshotPlaces& places) {
  if (places.has_recorded_segment()) count_in(places.recorded, entity);
  if (places.has_latents()) count_in(places.latent, entity);
}

uint64_t FreedBytes::careful() const {
  return exact_ + static_cast<uint64_t>(kCarefulShare * shares_);
}

double FreedBytes::share_in(uint32_t segment, const MemoryId& entity) const {
  const auto part = segments_[segment].parts.find(entity);
  return part == segments_[segment].parts.end() || !part->second.counts() ? 0 : part->second.each;
}

double FreedBytes::share(const MemoryId& entity, const SnapshotPlaces& places) const {
  double bytes = 0;
  if (places.has_recorded_segment()) bytes += share_in(places.recorded, entity);
  if (places.has_latents()) bytes += share_in(places.latent, entity);
  return bytes;
}

void FreedBytes::take_from(uint32_t number, const MemoryId& entity) {
  Segment& segment = segments_[number];
  Part& part = segment.parts[entity];
  ENGRAM_CHECK(part.left > 0, "segment {} has nothing left of '{}'", number, entity.to_string());
  if (part.went == 0) part.has_groups = segment.is_recorded && has_groups_(number, entity);
  const double before = segment.shares, part_before = part.shares();
  ++part.went;
  --part.left;
  segment.shares = --segment.left == 0 ? 0 : before + part.shares() - part_before;
  if (segment.left == 0) exact_ += segment.bytes;
  shares_ = std::max(0.0, shares_ + segment.shares - before);
}

void FreedBytes::take(const MemoryId& entity, const SnapshotPlaces& places) {
  if (places.has_recorded_segment()) take_from(places.recorded, entity);
  if (places.has_latents()) take_from(places.latent, entity);
}

}  // namespace engram::ltm
