// SPDX-License-Identifier: Apache-2.0
#include "training/fade/fading_group.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace engram::training {

namespace {

/// Whether two latents are of one block. Latents that are read in order share the bytes of theirs;
/// others may have equal ones.
bool are_of_one_block(const ltm::Latent& a, const ltm::Latent& b) {
  if (a.place.count <= 1 || a.place.count != b.place.count) return false;
  return a.code.data() == b.code.data() || std::ranges::equal(a.code.bytes(), b.code.bytes());
}

/// Whether a block has rows on both sides of the boundary between two snapshots. Snapshots in
/// different segments share none.
bool share_a_block(const FadingGroup& group, const ltm::SnapshotEntry& entry,
                   const ltm::LatentSnapshot& next) {
  if (group.entries.back().latent->source != entry.latent->source) return false;
  // A block of snapshots with several instances may leave out some snapshots' instances, so all of
  // the group are looked at.
  for (const ltm::LatentSnapshot& before : group.latents)
    for (const ltm::LatentInstance& a : before.instances)
      for (const ltm::LatentInstance& b : next.instances)
        if (are_of_one_block(a.latent, b.latent)) return true;
  return false;
}

// A block has at most ltm::kMaxGroupImages rows, so it begins and ends within so many snapshots of
// each of its own.

Result<Time> earliest_of_block(ltm::Timeline& timeline, Time time) {
  for (size_t i = 0; i < ltm::kMaxGroupImages && time > Time::min(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto before, timeline.at_or_before(time - Duration(1)));
    if (!before || !before->latent) break;
    time = before->time;
  }
  return time;
}

Result<Time> latest_of_block(ltm::Timeline& timeline, Time time) {
  for (size_t i = 0; i < ltm::kMaxGroupImages && time < Time::max(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto after, timeline.at_or_after(time + Duration(1)));
    if (!after || !after->latent) break;
    time = after->time;
  }
  return time;
}

/// Collects groups, and visits those of which all snapshots are wanted.
class Grouping {
 public:
  Grouping(const TimeSet& times, const std::function<Status(FadingGroup)>& visit)
      : times_(times), visit_(visit) {}

  Status add(const ltm::SnapshotEntry& entry, ltm::LatentSnapshot latents) {
    if (!group_.entries.empty() && !share_a_block(group_, entry, latents))
      ENGRAM_RETURN_IF_ERROR(finish());
    wanted_ += times_.contains(entry.time) ? 1 : 0;
    group_.entries.push_back(entry);
    group_.latents.push_back(std::move(latents));
    return {};
  }

  Status finish() {
    FadingGroup group = std::exchange(group_, {});
    const uint64_t wanted = std::exchange(wanted_, 0);
    if (wanted == 0) return {};
    if (wanted == group.entries.size()) return visit_(std::move(group));
    waiting_ += wanted;
    return {};
  }

  [[nodiscard]] uint64_t waiting() const { return waiting_; }

 private:
  const TimeSet& times_;
  const std::function<Status(FadingGroup)>& visit_;
  FadingGroup group_;
  uint64_t wanted_ = 0;  ///< Snapshots of the group that are in times_.
  uint64_t waiting_ = 0;
};

}  // namespace

size_t FadingGroup::rows() const {
  size_t rows = 0;
  for (const ltm::LatentSnapshot& snapshot : latents) rows += snapshot.instances.size();
  return rows;
}

void FadingGroup::add_to(FadingGroup& part, size_t snapshot) const {
  part.entries.push_back(entries[snapshot]);
  part.latents.push_back(latents[snapshot]);
}

void FadingGroup::add(FadingGroup later) {
  std::ranges::move(later.entries, std::back_inserter(entries));
  std::ranges::move(later.latents, std::back_inserter(latents));
}

uint64_t FadingGroup::bytes() const {
  std::set<const std::byte*> seen;
  uint64_t bytes = 0;
  for (const ltm::LatentSnapshot& snapshot : latents)
    for (const ltm::LatentInstance& instance : snapshot.instances)
      if (seen.insert(instance.latent.code.data()).second) bytes += instance.latent.code.size();
  return bytes;
}

void FadingGroup::replace(std::vector<ltm::Latent> codes,
                          std::span<const ltm::LatentQuality> qualities) {
  ENGRAM_CHECK(codes.size() == qualities.size(), "{} codes, {} qualities", codes.size(),
               qualities.size());
  size_t at = 0;
  for (ltm::LatentSnapshot& snapshot : latents) {
    for (ltm::LatentInstance& instance : snapshot.instances) {
      ENGRAM_CHECK(at < codes.size(), "only {} codes", codes.size());
      instance.latent.code = std::move(codes[at].code);
      instance.latent.place = codes[at].place;
      instance.quality = qualities[at++];
    }
  }
}

bool is_cut(const FadingGroup& group) {
  struct Block {
    uint32_t rows = 0, count = 0;
  };
  std::map<const std::byte*, Block> blocks;
  for (const ltm::LatentSnapshot& snapshot : group.latents) {
    for (const ltm::LatentInstance& instance : snapshot.instances) {
      Block& block = blocks[instance.latent.code.data()];
      ++block.rows;
      block.count = instance.latent.place.count;
    }
  }
  return std::ranges::any_of(
      blocks, [](const auto& block) { return block.second.rows < block.second.count; });
}

Result<uint64_t> for_each_group(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                                const TimeSet& times,
                                const std::function<Status(FadingGroup)>& visit) {
  if (times.empty()) return uint64_t{0};
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader.timeline(entity));
  ENGRAM_ASSIGN_OR_RETURN(const Time first, earliest_of_block(*timeline, times.front()));
  ENGRAM_ASSIGN_OR_RETURN(const Time last, latest_of_block(*timeline, times.back()));
  Grouping grouping(times, visit);
  ENGRAM_RETURN_IF_ERROR(
      timeline->for_each(first, last, [&](const ltm::SnapshotEntry& entry) -> Status {
        if (!entry.latent) return grouping.finish();
        ENGRAM_ASSIGN_OR_RETURN(ltm::LatentSnapshot latents, reader.read_latent(entity, entry));
        return grouping.add(entry, std::move(latents));
      }));
  ENGRAM_RETURN_IF_ERROR(grouping.finish());
  return grouping.waiting();
}

}  // namespace engram::training
