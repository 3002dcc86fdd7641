// SPDX-License-Identifier: Apache-2.0
//
// The part of DeepModel that makes blocks of values: as latents or videos, and as gists.
#include <algorithm>

#include "encoders/deep_model.h"
#include "ltm/codec/group_codec.h"

namespace engram::encoders {

std::vector<idf::NdArray> DeepModel::images_of(size_t image,
                                               std::span<const idf::SplitValue> values) const {
  std::vector<idf::NdArray> images;
  for (const idf::SplitValue& value : values)
    images.push_back(value.tensors[plan.images()[image].member]);
  return images;
}

Status DeepModel::add_video(size_t image, std::span<const idf::NdArray> images,
                            LatentRows& rows) const {
  const FrameShape& frame = codec.chain.frames[image];
  for (const std::string_view name : {"av1", "h264", "ffv1"}) {
    const auto video = ltm::make_group_codec(name);
    if (!video.ok() || !(*video)->accepts(frame.type, frame.shape)) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto group, (*video)->encode(images));
    StoredVideo stored = to_stored_video(name, std::move(group));
    rows.images[image].form = stored.form;
    rows.images[image].video = std::move(stored.bytes);
    return {};
  }
  return invalid_argument("image '{}': no installed video codec takes {} x {} pixels",
                          plan.layout().members()[plan.images()[image].member].path,
                          plan.images()[image].height, plan.images()[image].width);
}

Status DeepModel::add_videos(std::span<const idf::SplitValue> values, LatentRows& rows) const {
  for (size_t i = 0; i < rows.images.size(); ++i)
    ENGRAM_RETURN_IF_ERROR(add_video(i, images_of(i, values), rows));
  return {};
}

Result<std::vector<ltm::Latent>> DeepModel::encode_as_gist(std::span<const idf::Data> values,
                                                           const GistOptions& options) const {
  if (values.size() > kMaxBlockRows)
    return invalid_argument("gist: found {} values, needs {} at most", values.size(),
                            kMaxBlockRows);
  std::vector<idf::SplitValue> split;
  LatentRows rows;
  rows.images.resize(plan.images().size());
  for (const idf::Data& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(split.emplace_back(), plan.split(value));
    const std::vector<double> numbers = plan.read_numbers(split.back());
    rows.numbers.insert(rows.numbers.end(), numbers.begin(), numbers.end());
  }
  for (size_t i = 0; i < rows.images.size(); ++i) {
    const std::vector<idf::NdArray> images = images_of(i, split);
    if (!can_be_gist(codec.chain.frames[i])) {
      ENGRAM_RETURN_IF_ERROR(add_video(i, images, rows));
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(rows.images[i].video, encode_gist(images, options));
    rows.images[i].form = ImageForm::kGist;
  }
  LatentBlockCodec one_chain = codec;
  one_chain.chain_rows = values.size();
  return latents_of(one_chain.encode({&rows, 1}, values.size()), std::move(split));
}

std::vector<ltm::Latent> latents_of(std::vector<std::byte> block,
                                    std::vector<idf::SplitValue> values) {
  const Buffer code = Buffer::take(std::move(block));
  const auto count = static_cast<uint32_t>(values.size());
  std::vector<ltm::Latent> latents;
  for (uint32_t i = 0; i < count; ++i)
    latents.push_back({code, std::move(values[i].remainder), {i, count}});
  return latents;
}

size_t DeepModel::max_rows() const {
  constexpr size_t kMaxBytes = size_t{64} << 20;
  size_t bytes = 1;
  for (const FrameShape& frame : codec.chain.frames)
    bytes += idf::size_bytes(frame.type, frame.shape).value_or(kMaxBytes);
  return std::clamp<size_t>(kMaxBytes / bytes, 1, kMaxBlockRows);
}

size_t DeepModel::block_rows() const {
  return codec.chain_rows * std::clamp<size_t>(max_rows() / codec.chain_rows, 1, kMaxChains);
}

Result<std::vector<ltm::Latent>> DeepModel::encode(std::span<const idf::Data> values) {
  std::vector<idf::SplitValue> split;
  for (const idf::Data& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(split.emplace_back(), plan.split(value));
  }
  return encode(std::move(split));
}

Result<std::vector<ltm::Latent>> DeepModel::encode(std::vector<idf::SplitValue> split) {
  ENGRAM_ASSIGN_OR_RETURN(const LatentRows rows, to_rows(split));
  std::vector<LatentRows> chains = cut_chains(rows, split.size(), codec.chain_rows);
  if (autoencoder->images.empty())
    for (size_t i = 0; i < chains.size(); ++i) {
      const auto rest = std::span(split).subspan(i * codec.chain_rows);
      ENGRAM_RETURN_IF_ERROR(
          add_videos(rest.first(std::min(codec.chain_rows, rest.size())), chains[i]));
    }
  const size_t count = split.size();
  return latents_of(codec.encode(chains, count), std::move(split));
}

}  // namespace engram::encoders
