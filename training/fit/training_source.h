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

/// A model of the same entity that training may go on from.
struct PreviousModel {
  std::filesystem::path file;
  int version = 0;
  uint64_t checksum = 0;
};

/// Values that were made of those that are trained on, by changing them on purpose: they are
/// trained on too, and never encoded, measured or counted as real ones.
struct AugmentedValues {
  /// Per run of consecutive values that were changed alike: which of the source's times each was
  /// made of, one after the other.
  std::vector<std::vector<size_t>> origins;
  /// Value `index` of run `run`.
  std::function<Result<idf::Data>(size_t run, size_t index)> read;
  size_t left_out = 0;    ///< Values that were made of others.
  uint64_t identity = 0;  ///< The same for the same values alone.
};

/// What one model is trained on: values of one layout, in the order of time.
struct TrainingSource {
  std::string entity;
  std::vector<Time> times;
  /// The value of times[index].
  std::function<Result<idf::Data>(size_t index)> read;
  /// That the values have; not given: what the first one shows.
  std::optional<idf::Layout> layout;

  /// Another entity whose numbers predictions may start from; empty: none.
  std::string condition_entity;
  /// Its value at or before times[index]; nothing where there is none.
  std::function<Result<std::optional<idf::Data>>(size_t index)> read_condition;

  /// Training starts from its weights where its networks have the same sizes, else anew.
  std::optional<PreviousModel> previous;
  /// Beside `times`: which of them that model has latents of. Where training starts from it, they
  /// are told again beside the others, see RowSampler. Empty: none.
  std::vector<bool> is_known;

  /// Trained on beside the others, at TrainOptions::augmented_share.
  std::optional<AugmentedValues> augmented;
};

}  // namespace engram::training
