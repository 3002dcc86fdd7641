// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "encoders/deep_model.h"
#include "encoders/stored_tensors.h"

namespace engram::encoders {

Result<std::vector<float>> DeepModel::global_code_of(const idf::Data& value) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::SplitValue split, plan.layout().split(value));
  ENGRAM_RETURN_IF_ERROR(check_global_code());
  ENGRAM_ASSIGN_OR_RETURN(const LatentRows rows, to_rows({&split, 1}));
  torch::NoGradGuard no_grad;
  return floats_of(global_code.of(to_latents(rows, 0)));
}

Result<std::vector<float>> DeepModel::global_code_of(const LatentRows& rows, size_t row,
                                                     const idf::List& remainder) {
  ENGRAM_RETURN_IF_ERROR(check_global_code());
  const bool has_all = std::ranges::all_of(
      rows.images, [](const ImageRows& image) { return image.form == ImageForm::kLatents; });
  if (!has_all) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, decode(rows, row, remainder));
    return global_code_of(value);
  }
  torch::NoGradGuard no_grad;
  return floats_of(global_code.of(to_latents(rows, row)));
}

Status DeepModel::check_global_code() const {
  if (global_code.is_known()) return {};
  return failed_precondition(
      "model of '{}': found no global code: it has no networks for images, or was trained before "
      "there were any; needs to be trained again",
      provenance.entity);
}

}  // namespace engram::encoders
