// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "encoders/torch.h"
#include "ltm/h5/h5.h"

// Includes LibTorch.

namespace engram::encoders {

/// Elements of a tensor, row by row.
[[nodiscard]] std::vector<float> floats_of(const torch::Tensor& tensor);

/// Writes the elements of tensors, one after the other, as one array of float32.
Status write_tensors(h5::File& file, const char* array, const std::vector<torch::Tensor>& tensors);

/// Reads them into tensors of the same sizes. It is safe on hostile files; `path` is for errors.
/// Errors: kDataLoss if there are more or fewer numbers than the tensors have elements, or one that
/// is not finite. Then the tensors are as they were.
Status read_tensors(const h5::File& file, const std::filesystem::path& path, const char* array,
                    std::vector<torch::Tensor>& tensors);

}  // namespace engram::encoders
