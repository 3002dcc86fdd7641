// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/saliency/saliency.h"

namespace engram::ltm {

/// One part of the saliency of a snapshot, explained.
struct SalientPart {
  SaliencyPart part = SaliencyPart::kChange;
  double value = 0;         ///< 0 to 1.
  double weight = 0;        ///< How much it counts; all together 1.
  double contribution = 0;  ///< Their product. All together are the saliency.
  std::string found;        ///< What was found: "position[0] is 0.83"; empty if nothing was.
  std::string expected;     ///< What was expected instead, or what it is measured by.
};

/// Why a snapshot is as salient as it is.
struct SalientMoment {
  MemoryId entity;
  Time time{};
  double saliency = 0;  ///< 0 to 1.
  uint64_t rank = 0;    ///< 1 for the most salient snapshot of its entity; equal ones share it.
  uint64_t count = 0;   ///< Snapshots of the entity that have a saliency.
  /// It is kept in the store. Otherwise no night has looked at it yet, and it was calculated just
  /// now.
  bool is_stored = false;
  uint64_t learned_from = 0;       ///< See SaliencyWeights.
  std::vector<SalientPart> parts;  ///< All, the greatest contribution first.
};

}  // namespace engram::ltm
