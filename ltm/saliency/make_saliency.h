// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/recall/model.h"
#include "ltm/recall/store_past.h"
#include "ltm/saliency/saliency.h"

namespace engram::ltm {

struct SaliencyOptions {
  /// Which entities are looked at; empty: all.
  std::function<bool(const MemoryId&)> matches{};
  /// Asked before each snapshot; true ends the job. What was done until then is kept.
  std::function<bool()> is_over{};
};

/// What was done.
struct SaliencyReport {
  uint64_t entities = 0;    ///< Entities of which something was calculated.
  uint64_t snapshots = 0;   ///< Snapshots whose parts were calculated.
  SaliencyWeights weights;  ///< Those that hold from now on.
};

/// Calculates the parts of the saliency of all sealed snapshots of a store that have none yet,
/// stores them beside their segments, and learns the weights from what was read since.
///
/// Make the codes of images before it (make_codes), because novelty and change of images are told
/// by them. A kill loses what was calculated since the last two million snapshots. It may run
/// beside a live writer and other jobs. Errors: those of StoreReader::open; kCancelled on `stop`;
/// kUnavailable, kResourceExhausted. An entity that cannot be read is logged and left out; a
/// snapshot that cannot be read is noted, and not looked at again. Source: docs/saliency.md.
Result<SaliencyReport> make_saliency(const std::filesystem::path& store, const ModelLoader& loader,
                                     const SaliencyOptions& options, const ProgressSink& progress,
                                     const std::stop_token& stop);

/// The entities of the provider segment of `entity`.
[[nodiscard]] std::vector<MemoryId> entities_beside(StoreReader& store, const MemoryId& entity);

}  // namespace engram::ltm
