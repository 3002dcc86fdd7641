// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/idf/layout.h"

namespace engram::training {

/// A model of the same entity that training may start from.
struct PreviousModel {
  std::filesystem::path file;
  int version = 0;
  uint64_t checksum = 0;
};

/// Augmented values: changed copies of training values. They are trained on, but never encoded,
/// measured or counted as real ones.
struct AugmentedValues {
  /// Per run of consecutive values with the same recipe: the index of the source's time from which
  /// each value was made, in order.
  std::vector<std::vector<size_t>> origins;
  /// Reads value `index` of run `run`.
  std::function<Result<idf::Data>(size_t run, size_t index)> read;
  size_t left_out = 0;    ///< Values made of snapshots outside the source.
  uint64_t identity = 0;  ///< A hash that identifies these values.
};

/// The training data of one model: values of one layout, in the order of time.
struct TrainingSource {
  std::string entity;
  std::vector<Time> times;
  /// Reads the value at times[index].
  std::function<Result<idf::Data>(size_t index)> read;
  /// Layout of the values; by default that of the first one.
  std::optional<idf::Layout> layout;

  /// Another entity whose numbers condition predictions; empty for none.
  std::string condition_entity;
  /// Reads the value of that entity at or before times[index], if there is one.
  std::function<Result<std::optional<idf::Data>>(size_t index)> read_condition;

  /// Training starts from the weights of this model if its networks have the same sizes.
  std::optional<PreviousModel> previous;
  /// Per time: whether that model has latents of it. If training starts from that model, such rows
  /// are replayed, see RowSampler. Empty if there are none.
  std::vector<bool> is_known;

  /// Snapshots of the entity and of the condition that are forgotten; -1 if unknown.
  int64_t forgotten = -1;

  /// Augmented values that are trained on with a share of TrainOptions::augmented_share.
  std::optional<AugmentedValues> augmented;
};

}  // namespace engram::training
