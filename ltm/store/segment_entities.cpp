// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_entities.h"

#include <algorithm>
#include <map>
#include <optional>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/store/packed_entities.h"

namespace engram::ltm {

namespace {

/// Finding an entity unpacks one block, in half a millisecond.
constexpr size_t kEntitiesPerBlock = 512;

const SegmentEntity* find_in(std::span<const SegmentEntity> entities, const MemoryId& entity) {
  const auto found = std::ranges::lower_bound(entities, entity, {}, &SegmentEntity::id);
  return found == entities.end() || found->id != entity ? nullptr : &*found;
}

}  // namespace

struct SegmentEntities::Packed {
  std::vector<EntityBlock> blocks;
  uint64_t size = 0;

  Mutex mutex;
  /// Blocks that were asked for before all were; nothing of one that is damaged. They stay, because
  /// find() returned pointers to them.
  std::map<size_t, std::vector<SegmentEntity>> unpacked ENGRAM_GUARDED_BY(mutex);
  std::optional<std::vector<SegmentEntity>> all ENGRAM_GUARDED_BY(mutex);
  Status damage ENGRAM_GUARDED_BY(mutex);

  Result<std::vector<SegmentEntity>> unpack(size_t number) const {
    const EntityBlock& block = blocks[number];
    ENGRAM_ASSIGN_OR_RETURN(auto entities, unpack_entities(block.packed));
    if (entities.size() != block.count)
      return data_loss("has {} entities, needs {}", entities.size(), block.count);
    if (entities.front().id != block.first)
      return data_loss("begins with '{}', needs '{}'", entities.front().id.to_string(),
                       block.first.to_string());
    const auto is_in_order = [](const SegmentEntity& a, const SegmentEntity& b) {
      return a.id < b.id;
    };
    if (std::ranges::adjacent_find(entities, std::not_fn(is_in_order)) != entities.end() ||
        (number + 1 < blocks.size() && !(entities.back().id < blocks[number + 1].first)))
      return data_loss("is not in the order of IDs");
    return entities;
  }

  /// Nothing where it is damaged.
  std::vector<SegmentEntity> readable(size_t number) ENGRAM_REQUIRES(mutex) {
    auto entities = unpack(number);
    if (entities.ok()) return *std::move(entities);
    if (damage.ok()) {
      damage = data_loss("block {} of packed entities, from '{}': {}", number,
                         blocks[number].first.to_string(), entities.status().message());
      log::warning("manifest: {}", damage.message());
    }
    return {};
  }

  const SegmentEntity* find(const MemoryId& entity) ENGRAM_REQUIRES(mutex) {
    if (all) return find_in(*all, entity);
    const auto above = std::ranges::upper_bound(blocks, entity, {}, &EntityBlock::first);
    if (above == blocks.begin()) return nullptr;
    const auto number = static_cast<size_t>(above - blocks.begin()) - 1;
    auto known = unpacked.find(number);
    if (known == unpacked.end()) known = unpacked.emplace(number, readable(number)).first;
    return find_in(known->second, entity);
  }

  const std::vector<SegmentEntity>& unpack_all() ENGRAM_REQUIRES(mutex) {
    if (all) return *all;
    // Room is not made for as many as the blocks claim: that may be any number.
    std::vector<SegmentEntity> entities;
    for (size_t i = 0; i < blocks.size(); ++i)
      if (const auto known = unpacked.find(i); known != unpacked.end())
        std::ranges::copy(known->second, std::back_inserter(entities));
      else
        std::ranges::move(readable(i), std::back_inserter(entities));
    return all.emplace(std::move(entities));
  }
};

Result<SegmentEntities> SegmentEntities::from_blocks(std::vector<EntityBlock> blocks) {
  auto packed = std::make_shared<Packed>();
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].count == 0) return data_loss("block {} of packed entities is empty", i);
    if (i > 0 && !(blocks[i - 1].first < blocks[i].first))
      return data_loss("block {} of packed entities is not in the order of IDs", i);
    // The sum of what a hostile manifest claims must not overflow.
    constexpr uint64_t kMaxCount = uint64_t{1} << 32;
    if (blocks[i].count > kMaxCount || packed->size + blocks[i].count > kMaxCount)
      return data_loss("block {} of packed entities claims {} entities", i, blocks[i].count);
    packed->size += blocks[i].count;
  }
  packed->blocks = std::move(blocks);
  SegmentEntities entities;
  entities.packed_ = std::move(packed);
  return entities;
}

size_t SegmentEntities::size() const {
  if (packed_) return packed_->size;
  return listed_ ? listed_->size() : 0;
}

const SegmentEntity* SegmentEntities::find(const MemoryId& entity) const {
  if (!packed_) return find_in(all(), entity);
  const MutexLock lock(packed_->mutex);
  return packed_->find(entity);
}

const std::vector<SegmentEntity>& SegmentEntities::all() const {
  static const std::vector<SegmentEntity> kNone;
  if (!packed_) return listed_ ? *listed_ : kNone;
  const MutexLock lock(packed_->mutex);
  return packed_->unpack_all();
}

Status SegmentEntities::verify() const {
  if (!packed_) return {};
  const MutexLock lock(packed_->mutex);
  packed_->unpack_all();
  return packed_->damage;
}

std::vector<SegmentEntity>& SegmentEntities::edit() {
  if (!listed_ || listed_.use_count() > 1)
    listed_ = std::make_shared<std::vector<SegmentEntity>>(all());
  packed_.reset();
  return *listed_;
}

const std::vector<EntityBlock>* SegmentEntities::blocks() const {
  return packed_ ? &packed_->blocks : nullptr;
}

Result<std::vector<EntityBlock>> pack_in_blocks(std::span<const SegmentEntity> entities) {
  std::vector<EntityBlock> blocks;
  for (size_t first = 0; first < entities.size(); first += kEntitiesPerBlock) {
    const size_t count = std::min(kEntitiesPerBlock, entities.size() - first);
    ENGRAM_ASSIGN_OR_RETURN(std::string packed, pack_entities(entities.subspan(first, count)));
    blocks.push_back({entities[first].id, count, std::move(packed)});
  }
  return blocks;
}

}  // namespace engram::ltm
