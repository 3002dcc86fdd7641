// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/ordered_regions.h"

#include <algorithm>

namespace engram::datasets {

OrderedRegions::OrderedRegions(Load load, std::vector<Region> regions, uint64_t memory_bytes)
    : load_(std::move(load)), max_bytes_(memory_bytes), regions_(std::move(regions)) {
  std::ranges::stable_sort(regions_, {}, &Region::start_time);
}

Status OrderedRegions::open_next(ReadingReport& report) {
  const size_t index = opened_.size();
  const Region& region = regions_[index];
  opened_.push_back(std::make_unique<Open>());
  Open& open = *opened_.back();
  auto loaded = load_(region);
  if (!loaded.ok()) {
    if (loaded.status().code() == StatusCode::kUnavailable) return loaded.status();
    report.damaged += std::max<uint64_t>(region.messages, 1);
    // A badly damaged file has thousands of broken chunks; the report stays readable.
    constexpr size_t kMaxNotes = 40;
    const bool has_room = report.not_carried.size() < kMaxNotes;
    ++report.not_carried[has_room ? loaded.status().message() : "further damaged chunks"];
    opened_.back().reset();
    return {};
  }
  open.region = region;
  open.entries = std::move(loaded->entries);
  open.bytes = std::move(loaded->bytes);
  std::ranges::stable_sort(open.entries, {}, &RegionMessages::Entry::time);
  if (open.entries.empty()) {
    opened_.back().reset();
    return {};
  }
  heads_.push({open.entries.front().time, index});
  in_memory_.push_front(index);
  memory_bytes_ += open.bytes.size();
  give_up_others(index);
  return {};
}

void OrderedRegions::give_up_others(size_t index) {
  while (memory_bytes_ > max_bytes_ && in_memory_.back() != index) {
    Buffer& last = opened_[in_memory_.back()]->bytes;
    memory_bytes_ -= last.size();
    last = {};
    in_memory_.pop_back();
  }
}

Status OrderedRegions::bring(size_t index) {
  Open& open = *opened_[index];
  const auto found = std::ranges::find(in_memory_, index);
  if (found != in_memory_.end()) {
    in_memory_.splice(in_memory_.begin(), in_memory_, found);
    return {};
  }
  ENGRAM_ASSIGN_OR_RETURN(RegionMessages loaded, load_(open.region));
  open.bytes = std::move(loaded.bytes);
  in_memory_.push_front(index);
  memory_bytes_ += open.bytes.size();
  give_up_others(index);
  return {};
}

Result<std::optional<std::span<const std::byte>>> OrderedRegions::next(ReadingReport& report) {
  if (finished_) {
    memory_bytes_ -= opened_[*finished_]->bytes.size();
    in_memory_.remove(*finished_);
    opened_[*finished_].reset();
    finished_.reset();
  }
  // A region is opened only when the merge reaches its first time, so no more regions are in memory
  // than overlap.
  while (opened_.size() < regions_.size() &&
         (heads_.empty() || regions_[opened_.size()].start_time <= heads_.top().time))
    ENGRAM_RETURN_IF_ERROR(open_next(report));
  if (heads_.empty()) return std::optional<std::span<const std::byte>>();
  const size_t index = heads_.top().index;
  heads_.pop();
  ENGRAM_RETURN_IF_ERROR(bring(index));
  Open& open = *opened_[index];
  const RegionMessages::Entry entry = open.entries[open.next++];
  if (open.next < open.entries.size())
    heads_.push({open.entries[open.next].time, index});
  else
    finished_ = index;
  return std::optional(open.bytes.bytes().subspan(entry.offset));
}

}  // namespace engram::datasets
