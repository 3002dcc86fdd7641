// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/freed_bytes.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// Of the shares in a segment that is written anew, what is counted on, and what each such file is
/// given to grow by (its headers, a worse dictionary).
constexpr double kCarefulShare = 0.7;
constexpr double kCarefulBytes = 8192;

double careful_part(double shares) {
  return std::max(0.0, kCarefulShare * shares - kCarefulBytes);
}

}  // namespace

SnapshotPlaces SnapshotPlaces::of(const SnapshotEntry& entry) {
  SnapshotPlaces places;
  if (entry.recorded)
    places.recorded = entry.recorded->rows > 0 ? entry.recorded->source : kJournal;
  if (entry.latent) places.latent = entry.latent->source;
  return places;
}

FreedBytes::FreedBytes(const Manifest& manifest) {
  segments_.resize(manifest.segments.size());
  for (size_t i = 0; i < segments_.size(); ++i) {
    segments_[i].bytes = manifest.segments[i].bytes;
    for (const SegmentEntity& part : manifest.segments[i].entities)
      if (part.snapshots > 0)
        segments_[i].each[part.id] =
            static_cast<double>(part.stored_bytes) / static_cast<double>(part.snapshots);
  }
}

void FreedBytes::count(const SnapshotPlaces& places) {
  if (places.has_recorded_segment()) ++segments_[places.recorded].left;
  if (places.has_latents()) ++segments_[places.latent].left;
}

double FreedBytes::share_in(uint32_t segment, const MemoryId& entity) const {
  const auto each = segments_[segment].each.find(entity);
  return each == segments_[segment].each.end() ? 0 : each->second;
}

double FreedBytes::share(const MemoryId& entity, const SnapshotPlaces& places) const {
  double bytes = 0;
  if (places.has_recorded_segment()) bytes += share_in(places.recorded, entity);
  if (places.has_latents()) bytes += share_in(places.latent, entity);
  return bytes;
}

void FreedBytes::take_from(uint32_t number, const MemoryId& entity) {
  Segment& segment = segments_[number];
  ENGRAM_CHECK(segment.left > 0, "segment {} has nothing left", number);
  const double before = segment.shares;
  segment.shares = --segment.left == 0 ? 0 : before + share_in(number, entity);
  if (segment.left == 0) exact_ += segment.bytes;
  shares_ = std::max(0.0, shares_ + segment.shares - before);
  careful_ = std::max(0.0, careful_ + careful_part(segment.shares) - careful_part(before));
}

void FreedBytes::take(const MemoryId& entity, const SnapshotPlaces& places) {
  if (places.has_recorded_segment()) take_from(places.recorded, entity);
  if (places.has_latents()) take_from(places.latent, entity);
}

}  // namespace engram::ltm
