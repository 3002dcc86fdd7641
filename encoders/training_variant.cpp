// SPDX-License-Identifier: Apache-2.0
#include "encoders/training_variant.h"

namespace engram::encoders {

std::string_view to_string(TrainingVariant variant) {
  constexpr std::array<std::string_view, kTrainingVariants.size()> kNames{"rate", "ae", "vae",
                                                                          "wae"};
  return kNames[static_cast<size_t>(variant)];
}

Result<TrainingVariant> training_variant_of(std::string_view name) {
  for (const TrainingVariant variant : kTrainingVariants)
    if (to_string(variant) == name) return variant;
  return invalid_argument("training variant: found '{}', needs rate, ae, vae or wae", name);
}

}  // namespace engram::encoders
