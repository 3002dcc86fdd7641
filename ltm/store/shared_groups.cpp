// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/shared_groups.h"

#include <algorithm>
#include <functional>
#include <string>
#include <tuple>

#include "ltm/idf/binary.h"

namespace engram::ltm {

namespace {

/// An entity with so many rows shares no group, unless kMaxAlone others have more.
constexpr size_t kMaxSharedRows = 32;
constexpr size_t kMaxAlone = 1024;
/// Fewer entities do not share: every reader of older programs understands their groups.
constexpr size_t kMinSharing = 32;
/// Number of entities from which a layout has a shared group, and max number of such groups. Those
/// of other layouts share one in which each value is kept whole.
constexpr size_t kMinOfLayout = 16;
constexpr size_t kMaxGroups = 64;

/// The media of a row: path, codec, element type and number of axes of each.
using MediaKey = std::vector<std::tuple<std::string, std::string, idf::ElementType, size_t>>;

/// Entities with equal keys may share a group: the layout of the first row, which of its numbers
/// become compressed columns, and the media of each row.
struct SharingKey {
  std::string layout;
  std::vector<bool> columns;
  MediaKey media;

  friend auto operator<=>(const SharingKey&, const SharingKey&) = default;
};

/// True for media that lie, or would lie, in one encoded group with those of other rows.
bool is_grouped(const PackedMedium& medium, const SealRules& rules) {
  return medium.group || rules.group_codec(medium.path, medium.type, medium.shape) != nullptr;
}

MediaKey media_of(const PackedInstance& instance) {
  MediaKey key;
  for (const PackedMedium& medium : instance.value.media)
    key.emplace_back(medium.path, medium.codec, medium.type, medium.shape.size());
  return key;
}

SharingKey key_of(const PackedInstance& first, const SealRules& rules) {
  SharingKey key;
  const idf::Layout layout = idf::Layout::of(first.value.rest);
  const auto bytes = idf::encode(layout.to_data(), idf::kMaxDepth + idf::kContainerDepth);
  if (bytes.ok()) key.layout = as_text(*bytes);
  if (!rules.empty())
    for (const idf::TensorMember& member : layout.members())
      key.columns.push_back(rules.are_columns(member.path));
  key.media = media_of(first);
  return key;
}

const PackedInstance* first_row_of(const RecordedEntity& entity) {
  for (const PackedSnapshot& snapshot : entity.snapshots)
    if (!snapshot.instances.empty()) return &snapshot.instances.front();
  return nullptr;
}

/// Whether all rows have the same media, and none of them with other rows. Media that few rows of a
/// group have would cost each of its rows some bytes.
bool has_plain_media(const RecordedEntity& entity) {
  const PackedInstance* first = first_row_of(entity);
  for (const PackedSnapshot& snapshot : entity.snapshots)
    for (const PackedInstance& instance : snapshot.instances) {
      if (media_of(instance) != media_of(*first)) return false;
      for (const PackedMedium& medium : instance.value.media)
        if (is_grouped(medium, entity.rules)) return false;
    }
  return true;
}

class GroupPlanner {
 public:
  explicit GroupPlanner(const std::map<MemoryId, RecordedEntity>& entities) {
    for (const auto& [id, entity] : entities) {
      all_.emplace_back(&id, &entity);
      rows_.push_back(row_count_of(entity));
    }
  }

  GroupPlan plan() {
    find_max_rows();
    std::vector<EntityRef> rare;
    for (size_t i = 0; i < all_.size(); ++i) {
      const bool is_rare = rows_[i] <= max_rows_ && has_plain_media(*all_[i].second);
      (is_rare ? rare : plan_.alone).push_back(all_[i]);
    }
    if (rare.size() < kMinSharing) return {std::move(all_), {}};
    share(rare);
    return std::move(plan_);
  }

 private:
  void find_max_rows() {
    if (all_.size() <= kMaxAlone) return;
    std::vector<size_t> rows = rows_;
    std::ranges::nth_element(rows, rows.begin() + kMaxAlone, std::greater());
    max_rows_ = std::max(max_rows_, rows[kMaxAlone]);
  }

  void share(const std::vector<EntityRef>& rare) {
    std::map<SharingKey, std::vector<EntityRef>> of_key;
    std::vector<EntityRef> mixed;
    for (const EntityRef& entity : rare) {
      // Those that have drops alone have no row.
      if (const PackedInstance* first = first_row_of(*entity.second))
        of_key[key_of(*first, entity.second->rules)].push_back(entity);
      else
        mixed.push_back(entity);
    }
    std::vector<std::pair<const SharingKey*, std::vector<EntityRef>*>> order;
    for (auto& [key, entities] : of_key) order.emplace_back(&key, &entities);
    std::ranges::stable_sort(order, std::greater(),
                             [](const auto& one) { return one.second->size(); });
    for (const auto& [key, entities] : order) {
      if (entities->size() >= kMinOfLayout && plan_.shared.size() < kMaxGroups)
        plan_.shared.push_back(std::move(*entities));
      else
        std::ranges::copy(*entities, std::back_inserter(key->media.empty() ? mixed : plan_.alone));
    }
    sort(plan_.alone);
    sort(mixed);
    if (!mixed.empty()) plan_.shared.push_back(std::move(mixed));
  }

  static void sort(std::vector<EntityRef>& entities) {
    std::ranges::sort(entities,
                      [](const EntityRef& a, const EntityRef& b) { return *a.first < *b.first; });
  }

  std::vector<EntityRef> all_;
  std::vector<size_t> rows_;  ///< Of each of them.
  size_t max_rows_ = kMaxSharedRows;
  GroupPlan plan_;
};

}  // namespace

size_t row_count_of(const RecordedEntity& entity) {
  size_t rows = 0;
  for (const PackedSnapshot& snapshot : entity.snapshots) rows += snapshot.instances.size();
  return rows;
}

GroupPlan plan_groups(const std::map<MemoryId, RecordedEntity>& entities) {
  return GroupPlanner(entities).plan();
}

}  // namespace engram::ltm
