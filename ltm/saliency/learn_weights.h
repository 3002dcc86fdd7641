// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "ltm/saliency/stored_saliency.h"

namespace engram::ltm {

/// Learns which parts tell that a snapshot is asked for later, in closed form.
///
/// Whether a snapshot was read is regressed on its parts, both as differences from the mean of its
/// entity, so it does not count that some entities are asked for more than others; an entity of
/// which all or nothing was read tells nothing. Ridge regression, with parts left out one by one
/// whose coefficient would be negative. The weight of reads stays. The more snapshots were read,
/// the more what was learned counts beside the standard weights: as much for a thousand.
/// Source: docs/saliency.md, section "Weights".
class WeightLearner {
 public:
  /// Adds an entity. Shape: read [N], whether each snapshot was read.
  void add(const EntitySaliency& entity, const std::vector<bool>& read);

  /// The standard weights if fewer than kMinReads snapshots tell.
  [[nodiscard]] SaliencyWeights learn() const;

  static constexpr uint64_t kMinReads = 50;
  static constexpr double kReadsPerHalf = 1000;

 private:
  static constexpr size_t kFeatures = kSaliencyParts - 1;
  std::array<std::array<double, kFeatures>, kFeatures> products_{};  ///< Of parts.
  std::array<double, kFeatures> with_reads_{};                       ///< Of parts and reads.
  uint64_t reads_ = 0;
};

}  // namespace engram::ltm
