// SPDX-License-Identifier: Apache-2.0
#include "training/forms/block_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "training/forms/latent_refinement.h"
#include "training/forms/reference_choice.h"
#include "training/forms/view_choice.h"
#include "training/quality/psnr.h"

namespace engram::training {

using encoders::ImageForm;
using encoders::ImageRows;
using encoders::LatentRows;

namespace {

int64_t as_int(uint64_t bytes) {
  return static_cast<int64_t>(bytes);
}

/// Size of the backgrounds that a block carries.
uint64_t background_bytes(const LatentRows& rows) {
  uint64_t bytes = 0;
  for (const encoders::CodedBackground& background : rows.own) bytes += background.bytes.size();
  return bytes;
}

/// What the job knows about these images; else nothing is known. Videos begin from the references
/// of the model.
std::shared_ptr<EntityVideos> videos_for(const encoders::DeepModel& model,
                                         const RepresentationOptions& options) {
  const auto& images = model.plan.images();
  auto videos = options.videos;
  if (!videos || videos->members() != images.size()) {
    int64_t pixels = 0;
    for (const auto& image : images) pixels = std::max(pixels, int64_t{image.height} * image.width);
    videos = std::make_shared<EntityVideos>(images.size(), options.search(pixels));
  }
  for (size_t i = 0; i < images.size(); ++i)
    videos->search_of(i).use_references(open_references(model.codec.chain, i));
  return videos;
}

constexpr auto kLessBytes = [](const auto& a, const auto& b) { return a.bytes < b.bytes; };

}  // namespace

BlockChoice::BlockChoice(encoders::DeepModel& model, const RepresentationOptions& options,
                         StageTimes* times)
    : model_(model),
      options_(options),
      times_(times),
      bound_db_(options.bound_db + kDecodingMarginDb),
      max_mse_(mse_of_psnr(bound_db_)),
      videos_(model.plan, model.codec.chain_rows, videos_for(model, options), options.threads,
              times) {
  ENGRAM_CHECK(options.kind == Representation::kLatents || options.bound_db > 0, "no bound for {}",
               to_string(options.kind));
  counts_.representation = to_string(options.kind);
  counts_.bound_db = options.kind == Representation::kLatents ? 0 : options.bound_db;
  counts_.noise_images = options.noise_images;
  counts_.noise = options.noise;
}

encoders::StoredForms BlockChoice::counts() const {
  encoders::StoredForms counts = counts_;
  if (!can_correct_all_) counts.residual_bytes = 0;
  // Where it could not win it was not tried.
  if (lossless_tried_rows_ > 0 && lossless_tried_rows_ < counts.rows)
    counts.lossless_bytes = counts.lossless_bytes * counts.rows / lossless_tried_rows_;
  return counts;
}

const idf::NdArray& BlockChoice::recorded(const idf::SplitValue& value, size_t image) const {
  return value.tensors[model_.plan.images()[image].member];
}

Result<LatentRows> BlockChoice::seen(LatentRows rows, size_t count) const {
  if (!model_.codec.chain.numbers) return rows;
  const auto code = model_.codec.chain.numbers->encode(rows.numbers);
  ENGRAM_ASSIGN_OR_RETURN(rows.numbers, model_.codec.chain.numbers->decode(code, count));
  return rows;
}

Result<BlockChoice::Images> BlockChoice::decoded(const LatentRows& rows, size_t count) {
  Images images;
  for (size_t row = 0; row < count; ++row) {
    ENGRAM_ASSIGN_OR_RETURN(images.emplace_back(), model_.decode_images(rows, row));
  }
  return images;
}

Result<std::vector<std::vector<double>>> BlockChoice::errors_of(
    std::span<const idf::SplitValue> values, const Images& images) const {
  std::vector<std::vector<double>> errors;
  for (size_t row = 0; row < values.size(); ++row) {
    auto& own = errors.emplace_back(images[row].size(), std::numeric_limits<double>::infinity());
    for (size_t i = 0; i < own.size(); ++i) {
      if (model_.plan.images()[i].is_depth) continue;
      ENGRAM_ASSIGN_OR_RETURN(own[i], image_mse(recorded(values[row], i), images[row][i]));
    }
  }
  return errors;
}

int BlockChoice::refine_steps(const std::vector<std::vector<double>>& errors) const {
  if (options_.refine_steps > 0) return options_.refine_steps;
  double worst = 0;
  for (const auto& row : errors)
    for (const double mse : row) worst = std::max(worst, std::isfinite(mse) ? mse : 0);
  // A few steps close only a small gap, so blocks with a larger one are not refined.
  const double missed_by = bound_db_ - psnr_db(worst);
  return worst > max_mse_ && missed_by <= options_.refine_within_db ? options_.few_refine_steps : 0;
}

std::optional<BlockChoice::Candidate> BlockChoice::corrected(
    std::span<const idf::SplitValue> values, size_t image, const ImageRows& rows,
    const Images& images) const {
  // Residuals are for 8-bit images. Depth is kept lossless.
  if (model_.plan.images()[image].is_depth) return std::nullopt;
  const StageTimes::Scope scope(times_, Stage::kResiduals);
  encoders::ResidualEncoder residual(model_.codec.chain.frames[image].pixels());
  for (size_t row = 0; row < values.size(); ++row) {
    const auto wanted = recorded(values[row], image).values<uint8_t>();
    const auto max_error = static_cast<uint64_t>(max_mse_ * static_cast<double>(wanted.size()));
    if (!residual.add(images[row][image].values<uint8_t>(), wanted, max_error)) return std::nullopt;
  }
  Candidate candidate{rows, model_.codec.chain.images[image].encode(rows.latents).size()};
  candidate.rows.residual = residual.finish();
  candidate.bytes += candidate.rows.residual.size();
  return candidate;
}

Result<std::vector<std::vector<BlockChoice::Candidate>>> BlockChoice::latent_candidates(
    std::span<const idf::SplitValue> values, const LatentRows& rows, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(LatentRows guess, seen(rows, values.size()));
  ENGRAM_ASSIGN_OR_RETURN(const Images guessed, decoded(guess, values.size()));
  ENGRAM_ASSIGN_OR_RETURN(const auto errors, errors_of(values, guessed));
  for (const auto& row : errors)
    counts_.below_bound_rows +=
        std::ranges::count_if(row, [this](double mse) { return mse > max_mse_; });
  std::vector<std::vector<Candidate>> candidates(rows.images.size());
  const auto add = [&](size_t i, const ImageRows& latents, const Images& images) {
    if (auto candidate = corrected(values, i, latents, images))
      candidates[i].push_back(*std::move(candidate));
  };
  for (size_t i = 0; i < rows.images.size(); ++i) {
    add(i, rows.images[i], guessed);
    counts_.latent_bytes +=
        as_int(model_.codec.chain.images[i].encode(rows.images[i].latents).size());
  }
  const int steps = refine_steps(errors);
  if (steps == 0) return candidates;
  counts_.refine_tried_rows += static_cast<int64_t>(values.size() * rows.images.size());
  ENGRAM_ASSIGN_OR_RETURN(const LatentRows refined, refine_latents(model_, values, std::move(guess),
                                                                   {steps, bound_db_}, stop));
  ENGRAM_ASSIGN_OR_RETURN(const Images images, decoded(refined, values.size()));
  for (size_t i = 0; i < rows.images.size(); ++i) {
    if (refined.images[i].latents == rows.images[i].latents) continue;
    ImageRows latents = refined.images[i];
    latents.is_refined = true;
    add(i, latents, images);
  }
  return candidates;
}

void BlockChoice::add_videos(VideoSearchResult video, std::vector<Candidate>& candidates) {
  const size_t before = candidates.size();
  for (auto* found : {&video.lossy, &video.lossless}) {
    if (!*found) continue;
    Candidate& candidate = candidates.emplace_back();
    candidate.rows.form = (*found)->form;
    candidate.bytes = (*found)->size();
    candidate.rows.video = std::move((*found)->bytes);
    candidate.rows.residual = std::move((*found)->residual);
  }
  if (candidates.size() == before) return;
  if (video.lossless) {
    counts_.lossless_bytes += as_int(candidates.back().bytes);
    lossless_tried_rows_ += as_int(video.lossless->mse.size());
  }
  counts_.video_bytes += as_int(std::min(candidates[before].bytes, candidates.back().bytes));
}

void BlockChoice::count_kept(const Candidate& kept, size_t rows) {
  const auto count = static_cast<int64_t>(rows);
  const int64_t bytes = as_int(kept.bytes);
  counts_.kept_bytes += bytes;
  const auto add = [](int64_t& all_rows, int64_t more_rows, int64_t& all_bytes, int64_t more) {
    all_rows += more_rows;
    all_bytes += more;
  };
  if (kept.rows.form == ImageForm::kFfv1)
    return add(counts_.lossless_rows, count, counts_.lossless_kept_bytes, bytes);
  if (kept.rows.form != ImageForm::kLatents)
    return add(counts_.video_rows, count, counts_.video_kept_bytes, bytes);
  int64_t with_residual = 0;
  if (!kept.rows.residual.empty()) {
    const auto each = encoders::residual_bytes(kept.rows.residual, rows);
    ENGRAM_CHECK(each.ok(), "{}", each.status().message());
    with_residual = std::ranges::count_if(*each, [](const auto& row) { return row.has_value(); });
  }
  const int64_t latents = bytes - as_int(kept.rows.residual.size());
  const int64_t alone = latents * (count - with_residual) / count;
  add(counts_.residual_rows, with_residual, counts_.residual_kept_bytes, bytes - alone);
  if (kept.rows.is_refined)
    add(counts_.refined_rows, count - with_residual, counts_.refined_kept_bytes, alone);
  else
    add(counts_.latent_rows, count - with_residual, counts_.latent_kept_bytes, alone);
}

Result<BlockChoice::Choice> BlockChoice::choose(size_t image, std::vector<Candidate> candidates,
                                                std::optional<VideoSearchResult> video) {
  Choice choice;
  if (candidates.empty())
    can_correct_all_ = false;
  else
    choice.latents = std::move(*std::ranges::min_element(candidates, kLessBytes));
  if (!video) return choice;
  candidates.clear();
  add_videos(*std::move(video), candidates);
  if (!candidates.empty())
    choice.video = std::move(*std::ranges::min_element(candidates, kLessBytes));
  if (!choice.latents && !choice.video)
    return invalid_argument("image '{}': no form keeps {} dB: no installed video codec takes it",
                            model_.plan.layout().members()[model_.plan.images()[image].member].path,
                            options_.bound_db);
  return choice;
}

Result<BlockChoice::Choices> BlockChoice::choices_of(std::span<const idf::SplitValue> values,
                                                     const LatentRows& rows, Videos* videos,
                                                     const std::stop_token& stop) {
  std::vector<std::vector<Candidate>> candidates(rows.images.size());
  if (options_.kind != Representation::kVideo && has_networks()) {
    ENGRAM_ASSIGN_OR_RETURN(candidates, latent_candidates(values, rows, stop));
  }
  Choices choices;
  for (size_t i = 0; i < rows.images.size(); ++i) {
    std::optional<VideoSearchResult> video;
    if (videos != nullptr) {
      video = std::move((*videos)[i]);
    } else if (candidates[i].empty()) {
      ENGRAM_ASSIGN_OR_RETURN(video, videos_.of_chain(values, i, stop));
    }
    ENGRAM_ASSIGN_OR_RETURN(choices.emplace_back(),
                            choose(i, std::move(candidates[i]), std::move(video)));
  }
  return choices;
}

Status BlockChoice::keep_smallest(std::span<const idf::SplitValue> values,
                                  std::vector<LatentRows>& chains, const std::stop_token& stop,
                                  const Pause& pause) {
  std::vector<Videos> videos;
  if (options_.kind != Representation::kCorrected) {
    ENGRAM_ASSIGN_OR_RETURN(videos, videos_.of_block(values, stop, pause));
  }
  std::vector<Choices> choices;
  for (size_t i = 0; i < chains.size(); ++i) {
    if (pause && has_networks()) ENGRAM_RETURN_IF_ERROR(pause(i * model_.codec.chain_rows));
    ENGRAM_ASSIGN_OR_RETURN(choices.emplace_back(),
                            choices_of(chain_of(values, model_.codec.chain_rows, i), chains[i],
                                       videos.empty() ? nullptr : &videos[i], stop));
  }
  // The block pays for the background once, so it counts for the first chain that keeps latents.
  const uint64_t background = background_bytes(chains.front());
  uint64_t mixed = background, video = 0;
  bool needs_latents = false, keeps_latents = false;
  for (const Choices& of_chain : choices) {
    for (const Choice& choice : of_chain) {
      mixed += choice.smallest().bytes;
      if (choice.latents) counts_.residual_bytes += as_int(choice.latents->bytes);
      keeps_latents = keeps_latents || choice.keeps_latents();
      if (choice.video)
        video += choice.video->bytes;
      else
        needs_latents = true;
    }
  }
  if (has_networks()) {
    counts_.latent_bytes += as_int(background);
    counts_.residual_bytes += as_int(background);
  }
  // Latents may win in single chains and still not save enough to pay for the background.
  const bool is_all_video = !keeps_latents || (!needs_latents && video < mixed);
  uint64_t unpaid = is_all_video ? 0 : background;
  for (size_t at = 0; at < chains.size(); ++at) {
    if (is_all_video) chains[at].own.clear();
    for (size_t i = 0; i < choices[at].size(); ++i) {
      Choice& choice = choices[at][i];
      Candidate& kept = is_all_video ? *choice.video : choice.smallest();
      if (kept.rows.form == ImageForm::kLatents) kept.bytes += std::exchange(unpaid, 0);
      count_kept(kept, chain_of(values, model_.codec.chain_rows, at).size());
      chains[at].images[i] = std::move(kept.rows);
    }
  }
  return {};
}

Status BlockChoice::keep_latents(std::span<const idf::SplitValue> values, LatentRows& rows,
                                 uint64_t background, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(LatentRows start, seen(rows, values.size()));
  ENGRAM_ASSIGN_OR_RETURN(LatentRows refined, refine_latents(model_, values, std::move(start),
                                                             {options_.refine_steps, 0}, stop));
  counts_.latent_bytes += as_int(background);
  for (size_t i = 0; i < rows.images.size(); ++i) {
    const auto& codec = model_.codec.chain.images[i];
    counts_.latent_bytes += as_int(codec.encode(rows.images[i].latents).size());
    refined.images[i].is_refined = refined.images[i].latents != rows.images[i].latents;
    rows.images[i] = std::move(refined.images[i]);
    const uint64_t latents = codec.encode(rows.images[i].latents).size();
    count_kept({rows.images[i], latents + std::exchange(background, 0)}, values.size());
  }
  if (options_.refine_steps > 0)
    counts_.refine_tried_rows += static_cast<int64_t>(values.size() * rows.images.size());
  return {};
}

Result<BlockChoice::Values> BlockChoice::split(std::span<const idf::Data> values) const {
  Values split;
  for (const idf::Data& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(split.emplace_back(), model_.plan.split(value));
  }
  return split;
}

bool BlockChoice::finds_videos() const {
  const bool keeps_latents = options_.kind == Representation::kLatents && has_networks();
  return !keeps_latents && options_.kind != Representation::kCorrected &&
         !model_.plan.images().empty();
}

Status BlockChoice::find_ahead(std::span<const std::span<const idf::Data>> blocks,
                               const std::stop_token& stop, const Pause& pause) {
  if (!finds_videos()) return {};
  std::vector<Values> values;
  for (const auto& block : blocks) {
    ENGRAM_ASSIGN_OR_RETURN(values.emplace_back(), split(block));
  }
  return videos_.find_ahead({values.begin(), values.end()}, stop, pause);
}

bool BlockChoice::has_networks() const {
  return !model_.autoencoder->images.empty();
}

Result<std::vector<ltm::Latent>> BlockChoice::encode(std::span<const idf::Data> values,
                                                     const std::stop_token& stop,
                                                     const Pause& pause) {
  const StageTimes::Scope scope(times_, Stage::kLatents);
  ENGRAM_ASSIGN_OR_RETURN(Values split, this->split(values));
  const auto choosing = [&]() -> Status {
    if (stop.stop_requested()) return cancelled("encoding was stopped");
    return pause ? pause(0) : Status();
  };
  ENGRAM_ASSIGN_OR_RETURN(const LatentRows rows, rows_on_best_view(model_, split, choosing));
  counts_.rows += static_cast<int64_t>(split.size() * rows.images.size());
  auto chains = encoders::cut_chains(rows, split.size(), model_.codec.chain_rows);
  if (options_.kind == Representation::kLatents && has_networks()) {
    uint64_t background = background_bytes(rows);
    for (size_t i = 0; i < chains.size(); ++i) {
      if (pause) ENGRAM_RETURN_IF_ERROR(pause(i * model_.codec.chain_rows));
      ENGRAM_RETURN_IF_ERROR(keep_latents(chain_of(split, model_.codec.chain_rows, i), chains[i],
                                          std::exchange(background, 0), stop));
    }
  } else {
    ENGRAM_RETURN_IF_ERROR(keep_smallest(split, chains, stop, pause));
  }
  std::vector<std::byte> block = model_.codec.encode(chains, split.size());
  return encoders::latents_of(std::move(block), std::move(split));
}

}  // namespace engram::training
