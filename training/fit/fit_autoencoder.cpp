// SPDX-License-Identifier: Apache-2.0
#include "training/fit/fit_autoencoder.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "encoders/weight_rounding.h"
#include "training/fit/gradients.h"
#include "training/fit/image_units.h"
#include "training/fit/latent_regulariser.h"
#include "training/fit/row_rotation.h"
#include "training/fit/row_sampler.h"
#include "training/fit/view_change.h"

namespace engram::training {

using encoders::ImageLatents;
using encoders::Latents;
using torch::Tensor;

namespace {

constexpr double kAutoencoderRate = 1.5e-3;
/// Learning rate of backgrounds relative to the other parameters. It is lower, because medians are
/// good starts.
constexpr double kBackgroundRate = 0.5;
/// Share of the time in which noise stands in for rounding. After it latents are rounded.
constexpr double kNoiseShare = 0.5;
/// Share of the time with exact weights. After it weights are rounded as they will be stored.
constexpr double kExactShare = 0.75;
constexpr double kMaxAutoencoderGradient = 1.0;
/// Price of errors in variants whose price does not follow the quality.
constexpr double kUnsteeredPrice = 0.01;
/// Number of consecutive rows of a chunk, after one row that is only their past.
constexpr int64_t kChunk = 4;
constexpr double kShareOfNew = 0.02;

/// Makes a sampler that separates the rows that the dynamics must not learn from.
RowSampler make_sampler(const Dataset& data) {
  return {data.sequences, data.first_held_out, data.is_known};
}

/// The same for augmented rows: rows made of such rows are separated too.
std::optional<RowSampler> make_augmented_sampler(const Dataset& data) {
  if (!data.augmented) return std::nullopt;
  return RowSampler(data.augmented->sequences, data.augmented->first_held_out);
}

/// Consecutive rows of a batch.
struct Batch {
  std::vector<int64_t> rows;  ///< [chunks, kChunk + 1]
  /// Factors of the costs of all rows but the first of each chunk. [chunks * kChunk]
  Tensor weights;
  /// Whether the chunks end in parts that the dynamics must not learn from.
  bool is_held_out = false;
};

Batch draw(RowSampler& sampler, int64_t chunks) {
  Batch batch;
  std::vector<float> weights;
  for (const auto& [last, weight] : sampler.draw(chunks)) {
    batch.is_held_out = sampler.is_held_out(last);
    for (int64_t k = kChunk; k >= 0; --k)
      batch.rows.push_back(std::max(last - k, sampler.first_of(last)));
    weights.insert(weights.end(), kChunk, static_cast<float>(weight));
  }
  batch.weights = torch::tensor(weights);
  return batch;
}

/// Passes the cost of every row of a batch to the sampler. Shape: costs [chunks * kChunk].
void tell(RowSampler& sampler, const Batch& batch, const Tensor& costs) {
  const Tensor known = costs.to(torch::kFloat64).contiguous();
  for (int64_t i = 0; i < known.size(0); ++i) {
    const int64_t chunk = i / kChunk;
    const auto at = static_cast<size_t>(chunk * (kChunk + 1) + 1 + i % kChunk);
    sampler.told(batch.rows[at], known.data_ptr<double>()[i]);
  }
}

/// Selects rows `from` to `to` of every chunk of x [chunks * (kChunk + 1), ...], flattened.
Tensor of_chunks(const Tensor& x, int64_t from, int64_t to) {
  return x.unflatten(0, {-1, kChunk + 1}).slice(1, from, to).flatten(0, 1);
}

/// The row before each row. The first row counts as its own past.
Tensor before_each(const Tensor& x) {
  const Tensor rows = x.unflatten(0, {-1, kChunk + 1});
  return torch::cat({rows.slice(1, 0, 1), rows.slice(1, 0, kChunk - 1)}, 1).flatten(0, 1);
}

/// Selects the same part of all tensors of a batch.
template <typename Part>
Latents part_of(const Latents& latents, Part part) {
  Latents result{{}, {}, part(latents.scene)};
  for (const ImageLatents& image : latents.images)
    result.images.push_back({part(image.coarse), part(image.fine)});
  if (latents.numbers.defined()) result.numbers = part(latents.numbers);
  return result;
}

torch::optim::Adam make_optimiser(encoders::DeepModel& model,
                                  const LatentRegulariser& regulariser) {
  std::vector<Tensor> backgrounds;
  for (auto& image : model.autoencoder->images) backgrounds.push_back(image->background);
  std::vector<Tensor> rest = model.dynamics->parameters();
  for (const Tensor& parameter : regulariser.parameters()) rest.push_back(parameter);
  for (const auto& item : model.autoencoder->named_parameters())
    if (!item.key().ends_with("background")) rest.push_back(item.value());
  const auto options = [](double rate) {
    auto adam = std::make_unique<torch::optim::AdamOptions>(rate);
    adam->betas({0.9, 0.98});
    return adam;
  };
  std::vector<torch::optim::OptimizerParamGroup> groups;
  groups.emplace_back(rest, options(kAutoencoderRate));
  groups.emplace_back(backgrounds, options(kAutoencoderRate * kBackgroundRate));
  return torch::optim::Adam(groups, torch::optim::AdamOptions(kAutoencoderRate));
}

void set_rate(torch::optim::Adam& optimiser, double share) {
  const double rate = kAutoencoderRate * learning_rate_share(share);
  auto& groups = optimiser.param_groups();
  static_cast<torch::optim::AdamOptions&>(groups[0].options()).lr(rate);
  static_cast<torch::optim::AdamOptions&>(groups[1].options()).lr(rate * kBackgroundRate);
}

/// Rows of one chunk. Shape: [kChunk + 1, ...].
Tensor chunk_of(const Tensor& x, int64_t chunk) {
  return x.slice(0, chunk * (kChunk + 1), (chunk + 1) * (kChunk + 1));
}

/// The views of the chunks of a batch. The `values` of some chunks are changed to another view,
/// which has no scene.
class ChunkViews {
 public:
  /// Changes a share `varied_share` of the chunks if there is more than one scene. So the networks
  /// learn to use the background, which is all that they get of the next recording, instead of
  /// memorised scenes.
  ChunkViews(encoders::DeepModel& model, const Dataset& data, double varied_share,
             encoders::Parts& values)
      : scene_(values.scene.unflatten(0, {-1, kChunk + 1}).select(1, 0).clone()) {
    if (data.coded_backgrounds.empty()) return;
    const Tensor scenes = scene_.clone();
    std::vector<std::vector<Tensor>> backgrounds(values.images.size());
    for (int64_t chunk = 0; chunk < scenes.size(0); ++chunk) {
      const bool is_varied = torch::rand({1}).item<double>() < varied_share;
      // Numbers beside the images, such as joints, would not fit mirrored images.
      const ViewChange change = ViewChange::draw(!values.numbers.defined());
      const Tensor scene = scenes.slice(0, chunk, chunk + 1);
      const int64_t coded =
          (scene +
           torch::randint(encoders::kBackgroundQualities, {1}, torch::kLong) * data.scenes())
              .item<int64_t>();
      if (is_varied) scene_.slice(0, chunk, chunk + 1).fill_(-1);
      for (size_t i = 0; i < values.images.size(); ++i) {
        Tensor rows = chunk_of(values.images[i], chunk);
        const Tensor learned = model.autoencoder->images[i]->background;
        backgrounds[i].push_back(
            is_varied ? change.of(data.coded_background(model.autoencoder->shape, i, coded))
                      : learned.index_select(0, scene) * encoders::kGreyLevels);
        if (is_varied) rows.copy_(change.of(rows));
      }
    }
    for (const auto& of_chunks : backgrounds) backgrounds_.push_back(torch::cat(of_chunks));
  }

  /// For augmented rows: each chunk has the background of its own run.
  ChunkViews(const AugmentedRows& augmented, const Tensor& rows)
      : scene_(torch::full({rows.size(0) / (kChunk + 1)}, -1, torch::kLong)) {
    const Tensor runs =
        augmented.sequence.index_select(0, rows.unflatten(0, {-1, kChunk + 1}).select(1, 0));
    for (const Tensor& background : augmented.backgrounds)
      backgrounds_.push_back(background.index_select(0, runs));
  }

  /// Makes the views with the current weights, with one row per chunk.
  [[nodiscard]] encoders::Views look(encoders::DeepModel& model) const {
    return model.autoencoder->look(scene_, backgrounds_);
  }

  /// One for rows as they were recorded, zero for changed ones. Shape: [chunks * kChunk].
  [[nodiscard]] Tensor recorded() const {
    return scene_.ge(0).to(torch::kFloat32).repeat_interleave(kChunk);
  }

 private:
  Tensor scene_;                     ///< [chunks]; negative for a changed view.
  std::vector<Tensor> backgrounds_;  ///< Per image member [chunks, C, H, W], or empty.
};

/// The parts of the cost of a batch.
struct Cost {
  Tensor error;    ///< Mean squared error per row and image, in grey levels. [B, images]
  Tensor bits;     ///< [B]
  Tensor latents;  ///< Cost added by the training variant: [B] or one number. Unit: kilobytes.
};

Cost cost_of(encoders::DeepModel& model, LatentRegulariser& regulariser,
             const encoders::Parts& values, const ChunkViews& chunk_views, bool is_noisy) {
  const encoders::Views views = chunk_views.look(model);
  const RegularisedLatents all =
      regulariser.regularise(model.autoencoder->encode(values, views), is_noisy);
  const auto now_part = [](const Tensor& x) { return of_chunks(x, 1, kChunk + 1); };
  const Latents now = part_of(all.coded, now_part);
  const Latents last = part_of(all.coded, [](const Tensor& x) { return of_chunks(x, 0, kChunk); });
  const Latents before = part_of(all.coded, before_each);
  Cost cost;
  cost.bits = model.dynamics->bits(now, last, before);
  cost.latents = all.cost.dim() > 0 ? now_part(all.cost) : all.cost;
  const encoders::Parts decoded = model.autoencoder->decode(part_of(all.decoded, now_part), views);
  std::vector<Tensor> errors;
  for (size_t i = 0; i < values.images.size(); ++i)
    errors.push_back((decoded.images[i] - now_part(values.images[i])).square().mean({1, 2, 3}));
  cost.error = torch::stack(errors, 1);
  return cost;
}

/// Mean PSNR over the images of a row. Shape: [B].
Tensor row_psnr_db(const Tensor& error) {
  return (10.0 * torch::log10(255.0 * 255.0 / error.detach().clamp_min(1e-3))).mean(1);
}

/// Weighted mean over recent batches, which estimates the mean over equally likely rows.
class WeightedMean {
 public:
  explicit WeightedMean(double share_of_new) : sum_(share_of_new), weight_(share_of_new) {}

  void add(const Tensor& values, const Tensor& weights) {
    sum_.add((values.detach() * weights).sum().item<double>());
    weight_.add(weights.sum().item<double>());
  }
  [[nodiscard]] bool is_known() const { return weight_.value() > 0; }
  /// Zero if nothing was added.
  [[nodiscard]] double value() const { return is_known() ? sum_.value() / weight_.value() : 0; }

  /// All numbers that change, for checkpoints.
  [[nodiscard]] std::vector<double*> state() {
    std::vector<double*> all = sum_.state();
    std::ranges::copy(weight_.state(), std::back_inserter(all));
    return all;
  }

 private:
  Smoothed sum_, weight_;
};

/// Sets the backgrounds of new scenes. The others are those of the model that training starts from.
void start_from_new_backgrounds(encoders::DeepModel& model, const Dataset& data) {
  torch::NoGradGuard no_grad;
  for (size_t i = 0; i < data.backgrounds.size(); ++i)
    model.autoencoder->images[i]
        ->background.slice(0, data.known_scenes)
        .copy_(data.backgrounds[i].slice(0, data.known_scenes) / encoders::kGreyLevels);
}

}  // namespace

Result<FitStep> fit_autoencoder(encoders::DeepModel& model, const TrainingSource& source,
                                Dataset& data, const TrainOptions& options, FitLoop& loop,
                                FitSpeed& speed) {
  FitStep now;
  if (model.autoencoder->images.empty()) return now;
  start_from_new_backgrounds(model, data);
  const auto regulariser = make_latent_regulariser(options.variant, model.autoencoder->shape);
  auto optimiser = make_optimiser(model, *regulariser);
  std::vector<Tensor> parameters = optimiser.param_groups()[0].params();
  const int64_t chunks = std::max<int64_t>(1, options.batch_size / kChunk);
  const double size = size_in_usual_images(model.autoencoder->shape);
  ErrorPrice price(options.psnr_db, regulariser->is_steered() ? data.error_price : kUnsteeredPrice);
  RowSampler real_sampler = make_sampler(data);
  std::optional<RowSampler> augmented_sampler = make_augmented_sampler(data);
  // The requested quality is that of stored images, so only images as they were recorded count.
  const double real_share = data.augmented ? 1 - options.augmented_share : 1;
  const double recorded_share =
      (data.coded_backgrounds.empty() ? 1 : 1 - options.varied_share) * real_share;
  const double recent = kShareOfNew * (recorded_share > 0 ? std::max(recorded_share, 0.25) : 1);
  WeightedMean loss_mean(kShareOfNew), psnr(recent), bytes(recent);
  FitState state{model, optimiser, now, price.state()};
  for (const auto& more : {real_sampler.state(), loss_mean.state(), psnr.state(), bytes.state()})
    state.numbers.insert(state.numbers.end(), more.begin(), more.end());
  if (augmented_sampler)
    for (double* number : augmented_sampler->state()) state.numbers.push_back(number);
  ENGRAM_RETURN_IF_ERROR(loop.begin(state));
  RowRotation rotation(source, data, options.seed);
  for (;; ++now.step) {
    ENGRAM_ASSIGN_OR_RETURN(const double share, loop.next(state));
    ENGRAM_RETURN_IF_ERROR(rotation.advance(now.step, real_sampler));
    if (share >= 1.0) break;
    const std::clock_t start = std::clock();
    set_rate(optimiser, share);
    const bool is_augmented =
        augmented_sampler && torch::rand({1}).item<double>() < options.augmented_share;
    RowSampler& sampler = is_augmented ? *augmented_sampler : real_sampler;
    const Batch batch = draw(sampler, chunks);
    const Tensor rows = torch::tensor(batch.rows, torch::kLong);
    const auto& shape = model.autoencoder->shape;
    auto values = is_augmented ? data.augmented_batch(shape, rows) : data.batch(shape, rows);
    const ChunkViews views = is_augmented ? ChunkViews(*data.augmented, rows)
                                          : ChunkViews(model, data, options.varied_share, values);
    // Predictions are measured on held-out rows, so the prior is frozen there and only estimates
    // bits.
    std::optional<FrozenParameters> frozen;
    if (batch.is_held_out) frozen.emplace(*model.dynamics);
    std::optional<encoders::RoundedWeights> rounded;
    if (share >= kExactShare) rounded.emplace(*model.autoencoder);
    const Cost cost = cost_of(model, *regulariser, values, views, share < kNoiseShare);
    const Tensor costs =
        cost.error.mean(1) * price.value() + (cost.bits / kBitsOfKilobyte + cost.latents) / size;
    forget_gradients(optimiser);
    (costs * batch.weights).mean().backward();
    if (rounded) rounded->restore();
    torch::nn::utils::clip_grad_norm_(parameters, kMaxAutoencoderGradient);
    optimiser.step();
    tell(sampler, batch, costs.detach());
    loss_mean.add(costs, batch.weights);
    const Tensor told = recorded_share > 0 ? batch.weights * views.recorded() : batch.weights;
    psnr.add(row_psnr_db(cost.error), told);
    bytes.add(cost.bits / 8, told);
    if (regulariser->is_steered() && psnr.is_known()) price.follow(psnr.value(), share);
    now.loss = loss_mean.value();
    now.psnr_db = psnr.value();
    now.bytes = bytes.value();
    now.price = price.value();
    loop.tell(now);
    speed.images += chunks * kChunk;
    speed.processor_time += std::clock() - start;
  }
  return now;
}

}  // namespace engram::training
