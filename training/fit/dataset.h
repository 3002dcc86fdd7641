// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "encoders/deep_model.h"
#include "ltm/core/sequences.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Decoded augmented values in memory. Statistics of the dataset do not include them.
struct AugmentedRows {
  std::vector<Sequence> sequences;         ///< Runs of values with the same recipe.
  std::vector<size_t> first_held_out;      ///< Per sequence: first row made of held-out rows.
  std::vector<torch::Tensor> images;       ///< As of Dataset.
  torch::Tensor numbers;                   ///< As of Dataset.
  torch::Tensor sequence;                  ///< Sequence of each row, int64 [n].
  std::vector<torch::Tensor> backgrounds;  ///< Per image member [sequences, C, H, W], grey levels.

  [[nodiscard]] size_t size() const { return static_cast<size_t>(sequence.size(0)); }
};

/// Decoded values of consecutive snapshots.
struct DatasetRows {
  std::vector<Time> times;
  std::vector<torch::Tensor> images;  ///< As of Dataset.
  torch::Tensor plain_numbers;        ///< As of Dataset.
  torch::Tensor plain_conditions;     ///< As they were recorded, float64 [n, K]; NaN if unknown.
};

/// The decoded values that a model is trained on, in memory. Sequences are in the order of time
/// until RowRotation replaces some.
///
/// Threading: one thread.
struct Dataset {
  encoders::TensorPlan plan;
  std::vector<double> mean;       ///< Per number.
  std::vector<double> deviation;  ///< Per number; 0 if it never changed.
  std::vector<Time> times;
  std::vector<Sequence> sequences;  ///< Recordings to train on, or runs of them (thinning.h).
  /// Per sequence: first row of the held-out end of its recording, which prediction is not trained
  /// on.
  std::vector<size_t> first_held_out;
  std::vector<Sequence> source_rows;    ///< Per sequence: its rows of the source.
  std::vector<Sequence> left_out_runs;  ///< Rows of the source to train on without room in memory.
  size_t left_out_sequences = 0;
  std::vector<torch::Tensor> images;  ///< Per image member: pixels [n, H, W, C].
  torch::Tensor numbers;              ///< Normalised [n, N]; undefined without numbers.
  torch::Tensor plain_numbers;        ///< Not normalised, float64 [n, N].
  std::optional<encoders::Condition> condition;
  torch::Tensor conditions;                ///< Normalised [n, K]; undefined without a condition.
  torch::Tensor scene;                     ///< Background of each row, int64 [n].
  std::vector<torch::Tensor> backgrounds;  ///< Per image member [scenes, C, H, W], grey levels.
  /// The same after coding in each quality (code_background), as a block would carry them:
  /// pixels [qualities * scenes, H, W, C]; empty if there is only one scene or no codec accepts
  /// them. As floats they would take four times as much.
  std::vector<torch::Tensor> coded_backgrounds;
  /// The first scenes, which are those of the model that training starts from.
  int64_t known_scenes = 0;
  std::vector<bool> is_known;  ///< Per row: whether that model has latents of it.
  std::optional<AugmentedRows> augmented;
  double error_price = 0;  ///< Price at the end of that model's training; 0 if unknown.

  [[nodiscard]] size_t size() const { return times.size(); }
  [[nodiscard]] int scenes() const;

  /// Returns one of `coded_backgrounds`, which must not be empty, in grey levels.
  /// Shape: [1, C, H, W].
  [[nodiscard]] torch::Tensor coded_background(const encoders::NetworkShape& shape, size_t image,
                                               int64_t index) const;

  /// Replaces the values of a sequence by others of the same number, normalised as the old ones
  /// were. Scenes stay.
  void replace(size_t sequence, const DatasetRows& rows);

  /// Returns rows as input of the networks.
  /// Shape: indices int64 [B].
  [[nodiscard]] encoders::Parts batch(const encoders::NetworkShape& shape,
                                      const torch::Tensor& indices) const;

  /// The same for augmented rows, which have no scene.
  [[nodiscard]] encoders::Parts augmented_batch(const encoders::NetworkShape& shape,
                                                const torch::Tensor& indices) const;
};

/// Numbers by their means and deviations. What never changed, or is not finite, becomes 0.
/// Shape: plain [n, N] of float64 -> [n, N] of float32.
[[nodiscard]] torch::Tensor normalised(const torch::Tensor& plain, std::span<const double> mean,
                                       std::span<const double> deviation);

}  // namespace engram::training
