// SPDX-License-Identifier: Apache-2.0
#include "training/fit/fit_codec.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "encoders/coding/number_training.h"

namespace engram::training {

using encoders::NumberField;
using encoders::NumberKind;
using torch::Tensor;

namespace {

/// Default bound of a number, relative to its standard deviation.
constexpr double kRelativeBound = 0.005;
/// Min bound that a codec accepts.
constexpr double kMinScaleBound = 1e-150;
/// Default bound of an orientation. Unit: rad.
constexpr double kOrientationBound = 1e-3;
/// Max bound of an orientation that a codec accepts. Unit: rad.
constexpr double kMaxTurn = 1.0;

/// Latents of one image member in one sequence. Shape: [rows, coarse and fine latents].
std::vector<int32_t> integers_of(const encoders::ImageLatents& image, const Sequence& sequence) {
  const auto first = static_cast<int64_t>(sequence.first);
  const auto end = static_cast<int64_t>(sequence.end);
  const Tensor rows = torch::cat({image.coarse.slice(0, first, end).flatten(1),
                                  image.fine.slice(0, first, end).flatten(1)},
                                 1)
                          .to(torch::kInt32)
                          .contiguous();
  return {rows.data_ptr<int32_t>(), rows.data_ptr<int32_t>() + rows.numel()};
}

/// Makes one field per number or orientation. Without a requested bound each number has its own,
/// and numbers that never changed are exact.
std::vector<NumberField> fields_of(const Dataset& data, std::optional<double> bound) {
  if (bound == 0.0) return encoders::number_fields(data.plan.layout(), 0, 0);
  std::vector<NumberField> fields;
  size_t at = 0;
  const double turn = bound ? std::min(*bound, kMaxTurn) : kOrientationBound;
  for (const NumberField& field : encoders::number_fields(data.plan.layout(), 1.0, turn)) {
    if (field.kind != NumberKind::kBounded) {
      fields.push_back(field);
      at += field.count;
      continue;
    }
    for (uint32_t i = 0; i < field.count; ++i, ++at) {
      const double deviation = data.deviation[at];
      const double relative = std::max(deviation * kRelativeBound, kMinScaleBound);
      NumberField one{NumberKind::kBounded, 1, bound.value_or(relative)};
      if (!(deviation > 0)) one = {NumberKind::kExact, 1, 0};
      fields.push_back(one);
    }
  }
  return fields;
}

Result<encoders::NumberModel> number_model(const Dataset& data, const TrainOptions& options) {
  std::vector<std::vector<double>> recordings;
  for (const Sequence& sequence : data.sequences) {
    const Tensor rows =
        data.plain_numbers
            .slice(0, static_cast<int64_t>(sequence.first), static_cast<int64_t>(sequence.end))
            .contiguous();
    recordings.emplace_back(rows.data_ptr<double>(), rows.data_ptr<double>() + rows.numel());
  }
  encoders::NumberTraining training;
  training.block_rows = static_cast<size_t>(options.chain_rows);
  return encoders::train_number_model(fields_of(data, options.number_bound), recordings, training);
}

}  // namespace

Status fit_codec(encoders::DeepModel& model, const Dataset& data, const LatentTable& latents,
                 const TrainOptions& options) {
  model.codec.chain_rows = static_cast<size_t>(options.chain_rows);
  for (size_t i = 0; i < latents.images.size(); ++i) {
    std::vector<std::vector<int32_t>> sequences;
    for (const Sequence& sequence : data.sequences)
      sequences.push_back(integers_of(latents.images[i], sequence));
    model.codec.chain.images.emplace_back(
        encoders::LatentModel::train(model.autoencoder->shape.grids(i), sequences));
  }
  if (data.plan.number_count() == 0) return {};
  ENGRAM_ASSIGN_OR_RETURN(encoders::NumberModel numbers, number_model(data, options));
  model.codec.chain.numbers.emplace(std::move(numbers));
  return {};
}

}  // namespace engram::training
