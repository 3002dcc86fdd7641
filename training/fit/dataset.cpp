// SPDX-License-Identifier: Apache-2.0
#include "training/fit/dataset.h"

namespace engram::training {

using torch::Tensor;

int Dataset::scenes() const {
  return backgrounds.empty() ? 1 : static_cast<int>(backgrounds.front().size(0));
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
