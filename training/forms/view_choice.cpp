// SPDX-License-Identifier: Apache-2.0
#include "training/forms/view_choice.h"

#include <algorithm>
#include <limits>

#include "training/quality/quality_metrics.h"

namespace engram::training {

using encoders::CodedBackground;
using encoders::DeepModel;
using encoders::LatentRows;
using torch::Tensor;

namespace {

/// Max number of rows whose error is computed. Their mean stands for all rows.
constexpr size_t kMaxCompared = 12;

/// The medians of all image members.
Result<std::vector<idf::NdArray>> medians_of(const DeepModel& model,
                                             std::span<const idf::SplitValue> values) {
  std::vector<std::vector<Tensor>> images(model.plan.images().size());
  for (const idf::SplitValue& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(const auto parts, model.to_parts(value));
    for (size_t i = 0; i < images.size(); ++i) images[i].push_back(parts.images[i]);
  }
  std::vector<idf::NdArray> medians;
  for (size_t i = 0; i < images.size(); ++i)
    medians.push_back(encoders::to_image_array(model.plan.images()[i],
                                               std::get<0>(torch::cat(images[i]).median(0, true))));
  return medians;
}

/// Codes the backgrounds; empty if one of them cannot be coded.
Result<std::vector<CodedBackground>> coded(const DeepModel& model,
                                           std::span<const idf::NdArray> medians, size_t quality) {
  std::vector<CodedBackground> backgrounds;
  for (size_t i = 0; i < medians.size(); ++i) {
    if (model.plan.images()[i].is_depth) return std::vector<CodedBackground>();
    ENGRAM_ASSIGN_OR_RETURN(auto one, encoders::code_background(medians[i], quality));
    if (!one) return std::vector<CodedBackground>();
    backgrounds.push_back(*std::move(one));
  }
  return backgrounds;
}

/// Cost of rows in kilobytes: their size plus the price of their error.
Result<double> cost_of(DeepModel& model, std::span<const idf::SplitValue> values,
                       const LatentRows& rows) {
  double bytes = 0;
  for (const CodedBackground& background : rows.own)
    bytes += static_cast<double>(background.bytes.size());
  for (size_t i = 0; i < rows.images.size(); ++i)
    bytes += static_cast<double>(model.codec.chain.images[i].encode(rows.images[i].latents).size());
  double error = 0;
  double compared = 0;
  const size_t step = (values.size() + kMaxCompared - 1) / kMaxCompared;
  for (size_t row = step / 2; row < values.size(); row += step, ++compared) {
    ENGRAM_ASSIGN_OR_RETURN(const auto images, model.decode_images(rows, row));
    for (size_t i = 0; i < images.size(); ++i) {
      ENGRAM_ASSIGN_OR_RETURN(
          const double mse,
          grey_mse(values[row].tensors[model.plan.images()[i].member], images[i]));
      error += mse / static_cast<double>(images.size());
    }
  }
  const double known = model.provenance.error_price;
  const double price = known > 0 ? known : encoders::kUsualPrice;
  return bytes / 1000 + price * error / compared * static_cast<double>(values.size());
}

}  // namespace

Result<LatentRows> rows_on_best_view(DeepModel& model, std::span<const idf::SplitValue> values,
                                     const std::function<Status()>& pause) {
  ENGRAM_ASSIGN_OR_RETURN(LatentRows best, model.to_rows(values));
  if (model.autoencoder->images.empty()) return best;
  ENGRAM_ASSIGN_OR_RETURN(const auto medians, medians_of(model, values));
  ENGRAM_ASSIGN_OR_RETURN(double best_cost, cost_of(model, values, best));
  // Qualities are tried from the coarsest one until a better one costs more than it gains.
  double last_cost = std::numeric_limits<double>::infinity();
  for (size_t quality = encoders::kBackgroundQualities; quality-- > 0;) {
    if (pause) ENGRAM_RETURN_IF_ERROR(pause());
    ENGRAM_ASSIGN_OR_RETURN(auto own, coded(model, medians, quality));
    if (own.empty()) break;
    ENGRAM_ASSIGN_OR_RETURN(LatentRows rows, model.to_rows(values, std::move(own)));
    ENGRAM_ASSIGN_OR_RETURN(const double cost, cost_of(model, values, rows));
    if (cost >= last_cost) break;
    last_cost = cost;
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = std::move(rows);
  }
  return best;
}

}  // namespace engram::training
