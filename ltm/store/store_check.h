// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "ltm/store/finding.h"

namespace engram::ltm {

/// Opens a model file and tests it. The caller provides it, because the store does not depend on a
/// learning library.
using ModelTest = std::function<Status(const std::filesystem::path&)>;

struct CheckOptions {
  /// Also decodes every medium with its codec; otherwise only checksums are verified. Costs as much
  /// as reading all values.
  bool is_deep = false;
  /// Tests each model. If empty, only the checksums of models are verified.
  ModelTest test_model;
};

/// The result of a check: how much was checked, and the findings.
struct CheckReport {
  uint64_t generation = 0;  ///< Generation of the manifest; 0 if the manifest is damaged.
  uint64_t segments = 0;
  uint64_t models = 0;
  uint64_t journals = 0;
  uint64_t frames = 0;  ///< Whole frames in journals.
  /// Journals that end in the middle of a frame, of which nobody noted how much was acknowledged.
  uint64_t unknown_ends = 0;
  uint64_t entities = 0;
  uint64_t snapshots = 0;  ///< Snapshots in segments; one with several forms counts once for each.
  uint64_t instances = 0;  ///< Instances of these snapshots.
  uint64_t media = 0;      ///< Media of these snapshots.
  uint64_t bytes = 0;      ///< Size of all files, in bytes.
  std::vector<Finding> findings;

  [[nodiscard]] uint64_t faults() const;
  [[nodiscard]] bool is_clean() const { return faults() == 0; }
};

/// Reads a whole store and reports what is wrong with it. It changes nothing. Memory is bounded by
/// the largest journal. If a writer is live, one generation is checked.
///
/// Errors: kNotFound if there is no store; kFailedPrecondition if its format is newer than this
/// program's; kUnavailable; kCancelled.
/// Source: docs/format.md, section "Checking and recovering".
Result<CheckReport> check_store(const std::filesystem::path& store,
                                const CheckOptions& options = {}, const ProgressSink& progress = {},
                                const std::stop_token& stop = {});

}  // namespace engram::ltm
