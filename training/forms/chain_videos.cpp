// SPDX-License-Identifier: Apache-2.0
#include "training/forms/chain_videos.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <thread>
#include <utility>

#include "ltm/core/check.h"

namespace engram::training {

namespace {

/// Chains that are encoded at the same time.
constexpr size_t kWave = 4;

/// Calls `work` for each task, some of them at the same time. The caller works too.
template <typename Work>
void in_threads(int threads, size_t tasks, const Work& work) {
  std::atomic<size_t> next = 0;
  const auto run = [&] {
    for (size_t task = next++; task < tasks; task = next++) work(task);
  };
  std::vector<std::jthread> others;
  const size_t wanted = std::min(static_cast<size_t>(std::max(threads, 1)), tasks);
  for (size_t i = 1; i < wanted; ++i) others.emplace_back(run);
  run();
}

}  // namespace

std::span<const idf::SplitValue> chain_of(std::span<const idf::SplitValue> block, size_t chain_rows,
                                          size_t chain) {
  const auto rest = block.subspan(chain * chain_rows);
  return rest.first(std::min(chain_rows, rest.size()));
}

ChainVideos::ChainVideos(const encoders::TensorPlan& plan, size_t chain_rows,
                         std::shared_ptr<EntityVideos> videos, int threads, StageTimes* times)
    : plan_(plan),
      chain_rows_(chain_rows),
      videos_(std::move(videos)),
      threads_(threads),
      times_(times) {}

std::vector<ChainVideos::Block> ChainVideos::chains_of(Block block) const {
  std::vector<Block> chains;
  for (size_t at = 0; at * chain_rows_ < block.size(); ++at)
    chains.push_back(chain_of(block, chain_rows_, at));
  return chains;
}

Status ChainVideos::find_ahead(const std::vector<Block>& blocks, const std::stop_token& stop,
                               const Pause& pause) {
  ENGRAM_CHECK(ahead_.empty(), "{} chains were found ahead and not encoded", ahead_.size());
  std::vector<Block> chains;
  for (const Block& block : blocks) std::ranges::copy(chains_of(block), std::back_inserter(chains));
  ENGRAM_ASSIGN_OR_RETURN(auto found, find(chains, stop, pause));
  std::ranges::move(found, std::back_inserter(ahead_));
  return {};
}

Result<std::vector<ChainVideos::Found>> ChainVideos::of_block(Block block,
                                                              const std::stop_token& stop,
                                                              const Pause& pause) {
  const std::vector<Block> chains = chains_of(block);
  if (ahead_.empty()) return find(chains, stop, pause);
  ENGRAM_CHECK(ahead_.size() >= chains.size(), "{} chains were found ahead, of {}", ahead_.size(),
               chains.size());
  const auto end = ahead_.begin() + static_cast<ptrdiff_t>(chains.size());
  std::vector<Found> found(std::move_iterator(ahead_.begin()), std::move_iterator(end));
  ahead_.erase(ahead_.begin(), end);
  return found;
}

Result<VideoSearchResult> ChainVideos::of_chain(Block chain, size_t image,
                                                const std::stop_token& stop) {
  const StageTimes::Scope scope(times_, Stage::kVideo);
  std::optional<int>& encodes = encodes_.emplace_back();
  ENGRAM_ASSIGN_OR_RETURN(VideoSearchResult found, find(chain, image, stop, encodes));
  videos_->search_of(image).learn(found);
  return found;
}

Result<std::vector<ChainVideos::Found>> ChainVideos::find(const std::vector<Block>& chains,
                                                          const std::stop_token& stop,
                                                          const Pause& pause) {
  const StageTimes::Scope scope(times_, Stage::kVideo);
  const size_t members = plan_.images().size();
  std::vector<Found> videos(chains.size(), Found(members));
  std::vector<Status> failed(chains.size() * members);
  std::vector<std::optional<int>> encodes(chains.size() * members);
  size_t rows = 0;
  for (size_t first = 0; first < chains.size();) {
    // The first chain of all teaches the most, so it is alone.
    const bool is_first = members > 0 && videos_->search_of(0).history().is_empty();
    const size_t end = std::min(chains.size(), first + (is_first ? 1 : kWave));
    if (stop.stop_requested()) return cancelled("encoding was stopped");
    if (pause) ENGRAM_RETURN_IF_ERROR(pause(rows));
    in_threads(threads_, (end - first) * members, [&](size_t task) {
      const size_t at = first + task / members, image = task % members;
      auto found = find(chains[at], image, stop, encodes[at * members + image]);
      if (found.ok())
        videos[at][image] = *std::move(found);
      else
        failed[at * members + image] = found.status();
    });
    for (const Status& status : failed) ENGRAM_RETURN_IF_ERROR(status);
    for (; first < end; ++first) {
      rows += chains[first].size();
      for (size_t image = 0; image < members; ++image)
        videos_->search_of(image).learn(videos[first][image]);
    }
  }
  encodes_.insert(encodes_.end(), encodes.begin(), encodes.end());
  return videos;
}

Result<VideoSearchResult> ChainVideos::find(Block chain, size_t image, const std::stop_token& stop,
                                            std::optional<int>& encodes) {
  std::vector<idf::NdArray> images;
  for (const idf::SplitValue& value : chain)
    images.push_back(value.tensors[plan_.images()[image].member]);
  if (auto known = videos_->find(image, images)) return *std::move(known);
  ENGRAM_ASSIGN_OR_RETURN(VideoSearchResult found, videos_->search_of(image).search(images, stop));
  encodes = static_cast<int>(found.trials.size());
  videos_->add(images, found);
  return found;
}

}  // namespace engram::training
