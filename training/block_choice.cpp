// SPDX-License-Identifier: Apache-2.0
#include "training/block_choice.h"

#include "training/latent_refinement.h"
#include "training/quality/psnr.h"
#include "training/view_choice.h"

namespace engram::training {

using encoders::ImageForm;
using encoders::ImageRows;
using encoders::LatentRows;

BlockChoice::BlockChoice(encoders::DeepModel& model, const RepresentationOptions& options)
    : model_(model), options_(options) {
  counts_.representation = to_string(options.kind);
  counts_.bound_db = options.kind == Representation::kLatents ? 0 : options.bound_db;
  for (size_t i = 0; i < model.plan.images().size(); ++i)
    searches_.emplace_back(options.video, options.video_effort, options.bound_db);
}

Result<std::vector<bool>> BlockChoice::within_bound(const LatentRows& rows,
                                                    std::span<const idf::SplitValue> values) {
  std::vector<bool> is_within(rows.images.size(), true);
  for (size_t row = 0; row < values.size(); ++row) {
    ENGRAM_ASSIGN_OR_RETURN(const auto images, model_.decode_images(rows, row));
    for (size_t i = 0; i < images.size(); ++i) {
      const auto& member = model_.plan.images()[i];
      // Depth is kept within a bound of 8-bit images only by what has no loss.
      double mse = 0;
      if (!member.is_depth) {
        ENGRAM_ASSIGN_OR_RETURN(mse, image_mse(values[row].tensors[member.member], images[i]));
      }
      const bool is_below = member.is_depth || psnr_db(mse) < options_.bound_db;
      counts_.below_bound_rows += is_below ? 1 : 0;
      if (is_below) is_within[i] = false;
    }
  }
  return is_within;
}

Status BlockChoice::choose(size_t image, std::span<const idf::NdArray> images, ImageRows& rows,
                           bool is_within) {
  ENGRAM_ASSIGN_OR_RETURN(auto video, searches_[image].find(images));
  if (video) counts_.video_bytes += static_cast<int64_t>(video->bytes.size());
  const bool has_latents = !rows.latents.empty();
  if (!has_latents && !video)
    return invalid_argument(
        "image '{}': no installed video codec takes it",
        model_.plan.layout().members()[model_.plan.images()[image].member].path);
  const uint64_t latent_bytes =
      has_latents ? model_.codec.images[image].encode(rows.latents).size() : 0;
  counts_.latent_bytes += static_cast<int64_t>(latent_bytes);
  const bool keeps_latents =
      has_latents && (!video || (is_within && latent_bytes <= video->bytes.size()));
  if (keeps_latents) {
    counts_.latent_rows += static_cast<int64_t>(images.size());
    counts_.kept_bytes += static_cast<int64_t>(latent_bytes);
    return {};
  }
  counts_.kept_bytes += static_cast<int64_t>(video->bytes.size());
  rows.form = *encoders::form_of_codec(video->codec);
  (rows.form == ImageForm::kFfv1 ? counts_.lossless_rows : counts_.video_rows) +=
      static_cast<int64_t>(images.size());
  rows.video = std::move(video->bytes);
  rows.latents.clear();
  return {};
}

Result<std::vector<ltm::Latent>> BlockChoice::encode(std::span<const idf::Data> values,
                                                     const std::stop_token& stop) {
  std::vector<idf::SplitValue> split;
  for (const idf::Data& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(split.emplace_back(), model_.plan.layout().split(value));
  }
  ENGRAM_ASSIGN_OR_RETURN(LatentRows rows, rows_on_best_view(model_, split));
  const double bound_db = options_.kind == Representation::kAuto ? options_.bound_db : 0;
  ENGRAM_ASSIGN_OR_RETURN(rows, refine_latents(model_, split, std::move(rows),
                                               {options_.refine_steps, bound_db}, stop));
  const auto image_rows = static_cast<int64_t>(split.size() * rows.images.size());
  counts_.rows += image_rows;
  const bool needs_video = model_.autoencoder->images.empty();
  if ((options_.kind != Representation::kLatents || needs_video) && !rows.images.empty()) {
    std::vector<bool> is_within(rows.images.size(), false);
    if (!model_.autoencoder->images.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(is_within, within_bound(rows, split));
    }
    for (size_t i = 0; i < rows.images.size(); ++i) {
      std::vector<idf::NdArray> images;
      for (const idf::SplitValue& value : split)
        images.push_back(value.tensors[model_.plan.images()[i].member]);
      ENGRAM_RETURN_IF_ERROR(choose(i, images, rows.images[i], is_within[i]));
    }
  } else {
    counts_.latent_rows += image_rows;
    for (size_t i = 0; i < rows.images.size(); ++i)
      counts_.latent_bytes +=
          static_cast<int64_t>(model_.codec.images[i].encode(rows.images[i].latents).size());
    counts_.kept_bytes = counts_.latent_bytes;
  }
  std::vector<std::byte> block = model_.codec.encode(rows, split.size());
  return encoders::latents_of(std::move(block), std::move(split));
}

}  // namespace engram::training
