// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// Sums over the latents of one entity in one segment. Reports use them and need not open the
/// segment.
struct LatentSums {
  int model_version = 0;
  uint64_t image_rows = 0;   ///< Rows with image members.
  double psnr_db = 0;        ///< Sum over image rows; each capped at 60 dB.
  double image_mse = 0;      ///< Sum over image rows.
  uint64_t number_rows = 0;  ///< Rows with numeric members.
  double number_mse = 0;     ///< Sum over number rows.
};

/// Describes what one segment file contains of one entity.
struct SegmentEntity {
  MemoryId id;
  uint64_t snapshots = 0;
  uint64_t rows = 0;  ///< Instances.
  Time first{};
  Time last{};
  uint64_t raw_bytes = 0;      ///< Plain size of these snapshots, in bytes.
  uint64_t stored_bytes = 0;   ///< This entity's share of the file, in bytes.
  uint64_t dropped = 0;        ///< Snapshots that the online filters dropped in this span.
  uint64_t dropped_bytes = 0;  ///< Their plain bytes.
  LatentSums latent;           ///< Only in latent segments.
  uint64_t augmented = 0;      ///< Number of these snapshots that are augmented.
};

/// Some of the entities of a segment, in the order of their IDs, as a manifest has them: packed.
struct EntityBlock {
  MemoryId first;      ///< The first one of them.
  uint64_t count = 0;  ///< At least 1.
  std::string packed;  ///< See pack_entities.
};

/// What a segment contains, entity by entity, in the order of their IDs once it is published.
///
/// A manifest keeps many entities in packed blocks. Finding one unpacks its block alone, so opening
/// a store takes no longer for all those that nobody asks for; iterating unpacks all of them, once.
/// Copies share what they hold, and what was unpacked, until one is edited.
///
/// Blocks that are damaged, although the manifest's checksum says that they are as they were
/// written, have nothing that could be found. A warning tells of the first; verify() returns it.
///
/// Threading: as a container; what copies share is guarded.
/// Source: docs/format.md, section "Manifest".
class SegmentEntities {
 public:
  SegmentEntities() = default;
  SegmentEntities(std::vector<SegmentEntity> listed)
      : listed_(std::make_shared<std::vector<SegmentEntity>>(std::move(listed))) {}
  SegmentEntities(std::initializer_list<SegmentEntity> listed)
      : SegmentEntities(std::vector<SegmentEntity>(listed)) {}
  /// `blocks` must not be empty; its blocks must be in order. Errors: kDataLoss.
  static Result<SegmentEntities> from_blocks(std::vector<EntityBlock> blocks);

  /// As the blocks say, so iterating visits fewer where some are damaged.
  /// Complexity: O(1), nothing is unpacked.
  [[nodiscard]] size_t size() const;
  [[nodiscard]] bool empty() const { return size() == 0; }

  /// Null if the segment contains nothing of `entity`. Needs entities in order. Valid until edit(),
  /// as long as this or a copy is there.
  [[nodiscard]] const SegmentEntity* find(const MemoryId& entity) const;

  [[nodiscard]] const SegmentEntity* begin() const { return all().data(); }
  [[nodiscard]] const SegmentEntity* end() const { return begin() + all().size(); }
  [[nodiscard]] const SegmentEntity& front() const { return all().front(); }
  [[nodiscard]] const SegmentEntity& operator[](size_t index) const { return all()[index]; }
  [[nodiscard]] const SegmentEntity& at(size_t index) const { return all().at(index); }

  /// Unpacks all. Errors: kDataLoss.
  [[nodiscard]] Status verify() const;

  /// Unpacks them for good and lets them be changed, which copies do not see. Call verify() first:
  /// what cannot be unpacked is lost.
  [[nodiscard]] std::vector<SegmentEntity>& edit();

  /// Null if they are not packed.
  [[nodiscard]] const std::vector<EntityBlock>* blocks() const;

 private:
  struct Packed;
  [[nodiscard]] const std::vector<SegmentEntity>& all() const;

  /// At most one of the two is there.
  std::shared_ptr<std::vector<SegmentEntity>> listed_;
  std::shared_ptr<Packed> packed_;
};

/// Packs entities, which must be in order, in blocks. Recorded segments only.
/// Errors: kInvalidArgument.
Result<std::vector<EntityBlock>> pack_in_blocks(std::span<const SegmentEntity> entities);

}  // namespace engram::ltm
