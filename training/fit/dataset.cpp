// SPDX-License-Identifier: Apache-2.0
#include "training/fit/dataset.h"

#include <algorithm>

#include "ltm/core/check.h"

namespace engram::training {

using torch::Tensor;

int Dataset::scenes() const {
  return backgrounds.empty() ? 1 : static_cast<int>(backgrounds.front().size(0));
}

Tensor normalised(const Tensor& plain, std::span<const double> mean,
                  std::span<const double> deviation) {
  Tensor values = torch::zeros(plain.sizes());
  for (size_t i = 0; i < mean.size(); ++i)
    if (deviation[i] > 0)
      values.select(1, static_cast<int64_t>(i))
          .copy_(torch::nan_to_num(
              (plain.select(1, static_cast<int64_t>(i)) - mean[i]) / deviation[i], 0, 0, 0));
  return values;
}

Tensor Dataset::coded_background(const encoders::NetworkShape& shape, size_t image,
                                 int64_t index) const {
  return encoders::to_grey_levels(plan.images()[image], shape.images[image],
                                  coded_backgrounds[image].slice(0, index, index + 1));
}

void Dataset::replace(size_t sequence, const DatasetRows& rows) {
  const Sequence& place = sequences[sequence];
  ENGRAM_CHECK(rows.times.size() == place.size(), "{} rows in the place of {}", rows.times.size(),
               place.size());
  const auto of_place = [&](const Tensor& all) {
    return all.slice(0, static_cast<int64_t>(place.first), static_cast<int64_t>(place.end));
  };
  std::ranges::copy(rows.times, times.begin() + static_cast<ptrdiff_t>(place.first));
  for (size_t i = 0; i < images.size(); ++i) of_place(images[i]).copy_(rows.images[i]);
  of_place(plain_numbers).copy_(rows.plain_numbers);
  if (numbers.defined()) of_place(numbers).copy_(normalised(rows.plain_numbers, mean, deviation));
  if (conditions.defined())
    of_place(conditions)
        .copy_(normalised(rows.plain_conditions, condition->mean, condition->deviation));
}

encoders::Parts Dataset::batch(const encoders::NetworkShape& shape, const Tensor& indices) const {
  encoders::Parts parts;
  parts.scene = scene.index_select(0, indices);
  for (size_t i = 0; i < images.size(); ++i)
    parts.images.push_back(encoders::to_grey_levels(plan.images()[i], shape.images[i],
                                                    images[i].index_select(0, indices)));
  if (numbers.defined()) parts.numbers = numbers.index_select(0, indices);
  if (conditions.defined()) parts.conditions = conditions.index_select(0, indices);
  return parts;
}

encoders::Parts Dataset::augmented_batch(const encoders::NetworkShape& shape,
                                         const Tensor& indices) const {
  encoders::Parts parts;
  parts.scene = torch::zeros({indices.size(0)}, torch::kLong);
  for (size_t i = 0; i < augmented->images.size(); ++i)
    parts.images.push_back(encoders::to_grey_levels(plan.images()[i], shape.images[i],
                                                    augmented->images[i].index_select(0, indices)));
  if (augmented->numbers.defined()) parts.numbers = augmented->numbers.index_select(0, indices);
  return parts;
}

}  // namespace engram::training
