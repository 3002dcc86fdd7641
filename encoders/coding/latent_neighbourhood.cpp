// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/latent_neighbourhood.h"

namespace engram::encoders {

namespace {

/// Number of previous channels that are context of a latent.
constexpr int kChannelsBefore = 4;

}  // namespace

LatentNeighbourhood::LatentNeighbourhood(const LatentGrid& shape)
    : shape_(shape),
      stride_(static_cast<size_t>(shape.width) + 2),
      plane_((static_cast<size_t>(shape.height) + 2) * stride_),
      around_then_(plane_),
      channels_(plane_),
      change_(plane_) {
  for (Planes* planes : {&now_, &last_, &before_, &size_, &distance_})
    planes->assign(static_cast<size_t>(shape.channels) * plane_, 0);
  for (size_t latent = 0; latent < shape.count() / static_cast<size_t>(shape.channels); ++latent)
    places_.push_back((latent / (stride_ - 2) + 1) * stride_ + latent % (stride_ - 2) + 1);
}

void LatentNeighbourhood::begin_block() {
  rows_ = 0;
  std::ranges::fill(last_, 0);
  std::ranges::fill(before_, 0);
}

void LatentNeighbourhood::begin_channel(int channel) {
  first_ = static_cast<size_t>(channel) * plane_;
  std::ranges::fill(channels_, 0);
  std::ranges::fill(change_, 0);
  for (int i = std::max(0, channel - kChannelsBefore); i < channel; ++i) {
    const int8_t* size = size_.data() + static_cast<size_t>(i) * plane_;
    const int8_t* distance = distance_.data() + static_cast<size_t>(i) * plane_;
    for (size_t at = 0; at < plane_; ++at) {
      channels_[at] = static_cast<int8_t>(channels_[at] + size[at]);
      change_[at] = static_cast<int8_t>(change_[at] + distance[at]);
    }
  }
  const int8_t* last = last_.data() + first_;
  const auto size = [last](size_t at) { return std::abs(last[at]); };
  for (size_t at = stride_; at + stride_ < plane_; ++at)
    around_then_[at] = static_cast<int8_t>(2 * size(at) + size(at - 1) + size(at + 1) +
                                           size(at - stride_) + size(at + stride_));
}

void LatentNeighbourhood::end_row() {
  // The memory of the oldest row is reused for the next one.
  std::swap(before_, last_);
  std::swap(last_, now_);
  if (rows_++ == 0) before_ = last_;
}

void LatentNeighbourhood::find_changes(const LatentGrid& other, std::span<uint8_t> changes) const {
  std::vector<int8_t> sums(plane_);
  for (size_t at = 0; at < distance_.size(); at += plane_)
    for (size_t i = 0; i < plane_; ++i)
      sums[i] = static_cast<int8_t>(std::min(sums[i] + distance_[at + i], kMax));
  for (int y = 0; y < other.height; ++y)
    for (int x = 0; x < other.width; ++x)
      changes[static_cast<size_t>(y * other.width + x)] = static_cast<uint8_t>(
          of(latent_classes::kFewOf,
             sums[place(static_cast<size_t>(y * shape_.height / other.height * shape_.width +
                                            x * shape_.width / other.width))]));
}

}  // namespace engram::encoders
