// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "encoders/deep_model.h"
#include "training/fit/sequences.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Augmented values, decoded, in memory. No statistics are made of them.
struct AugmentedRows {
  std::vector<Sequence> sequences;         ///< Runs that were changed alike.
  std::vector<size_t> first_held_out;      ///< Per sequence: from there on what is measured shows.
  std::vector<torch::Tensor> images;       ///< As of Dataset.
  torch::Tensor numbers;                   ///< As of Dataset.
  torch::Tensor sequence;                  ///< Of each row, of int64 [n].
  std::vector<torch::Tensor> backgrounds;  ///< Per image member [sequences, C, H, W], grey levels.

  [[nodiscard]] size_t size() const { return static_cast<size_t>(sequence.size(0)); }
};

/// The values that a model is trained on, decoded, in memory, in the order of time.
///
/// Threading: one thread.
struct Dataset {
  encoders::TensorPlan plan;
  std::vector<double> mean;       ///< Per number.
  std::vector<double> deviation;  ///< Per number; 0 where it never changed.
  std::vector<Time> times;
  std::vector<Sequence> sequences;  ///< Those to train on.
  size_t left_out_sequences = 0;
  std::vector<torch::Tensor> images;  ///< Per image member: pixels [n, H, W, C].
  torch::Tensor numbers;              ///< Normalised [n, N]; undefined without numbers.
  torch::Tensor plain_numbers;        ///< As they were, of float64 [n, N].
  std::optional<encoders::Condition> condition;
  torch::Tensor conditions;                ///< Normalised [n, K]; undefined without a condition.
  torch::Tensor scene;                     ///< Which background a row belongs to, of int64 [n].
  std::vector<torch::Tensor> backgrounds;  ///< Per image member [scenes, C, H, W], grey levels.
  /// The same as blocks would carry them, in each quality (code_background): [qualities * scenes,
  /// C, H, W]; empty where there is one scene alone, or where no codec takes them.
  std::vector<torch::Tensor> coded_backgrounds;
  int64_t known_scenes = 0;    ///< The first ones are of the model that is gone on from.
  std::vector<bool> is_known;  ///< Per row: whether that model has latents of it.
  std::optional<AugmentedRows> augmented;
  double error_price = 0;  ///< What that model's training ended with; 0: unknown.

  [[nodiscard]] size_t size() const { return times.size(); }
  [[nodiscard]] int scenes() const;

  /// Rows as the networks see them. Shape: indices [B] of int64.
  [[nodiscard]] encoders::Parts batch(const encoders::NetworkShape& shape,
                                      const torch::Tensor& indices) const;

  /// The same of the augmented rows, which belong to no scene.
  [[nodiscard]] encoders::Parts augmented_batch(const encoders::NetworkShape& shape,
                                                const torch::Tensor& indices) const;
};

}  // namespace engram::training
