// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <future>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "training/fit/dataset.h"
#include "training/fit/row_sampler.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Lets a fit see all recordings although only runs of them are in memory: step by step, runs that
/// were trained on make room for others, which a thread reads ahead.
///
/// A run takes the place of one of the same length, so that neighbours stay neighbours, and the
/// background that is nearest to it. What is held out stays. Runs come in a random order that
/// depends on the seed alone, and one comes after a fixed number of steps, so the same steps see
/// the same rows.
///
/// Threading: one thread. Another one reads from the source, which nothing else may use meanwhile.
/// Source: docs/learning_methods.md, section "The image autoencoder".
class RowRotation {
 public:
  /// Source and data must outlive it. Does nothing if all runs are in memory.
  RowRotation(const TrainingSource& source, Dataset& data, uint64_t seed);

  /// Brings in what is due before the step. Where a fit goes on from a checkpoint, the first call
  /// reads what the last process had in memory.
  /// Errors: those of the source.
  Status advance(int64_t step, RowSampler& sampler);

 private:
  /// Length of a run, and whether the previous model has latents of its first row.
  using Kind = std::pair<size_t, bool>;
  /// The run that comes into a place.
  struct Swap {
    size_t place = 0;  ///< Index of a sequence of the dataset.
    Sequence run;      ///< Rows of the source.
  };

  /// A swap whose rows are read meanwhile.
  struct Ahead {
    Swap swap;
    std::future<Result<DatasetRows>> rows;
  };

  [[nodiscard]] Kind kind_of(const Sequence& run) const;
  Swap next_swap();
  void read_next();
  void put(const Swap& swap, const DatasetRows& rows);
  /// Reads what is in memory after so many swaps. The costs of its rows came with the checkpoint.
  Status catch_up(int64_t swaps);

  const TrainingSource& source_;
  Dataset& data_;
  std::map<Kind, std::deque<size_t>> places_;  ///< The one that is replaced next comes first.
  std::deque<Sequence> waiting_;
  std::vector<Sequence> in_place_;  ///< Per sequence of the dataset: its rows of the source.
  int64_t done_ = 0;                ///< Swaps.
  bool has_begun_ = false;
  /// What comes next. The last member: its thread uses the others.
  std::optional<Ahead> ahead_;
};

}  // namespace engram::training
