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

/// Opens a model file and tests it. Given from above: the store knows no learning library.
using ModelTest = std::function<Status(const std::filesystem::path&)>;

struct CheckOptions {
  /// Decode every medium by its codec, too; otherwise its checksum must do. Costs as much as
  /// reading all values.
  bool is_deep = false;
  /// Empty: the checksums of models must do.
  ModelTest test_model;
};

/// What a check looked at, and what it found.
struct CheckReport {
  uint64_t generation = 0;  ///< Of the manifest; 0 where that is broken.
  uint64_t segments = 0;
  uint64_t models = 0;
  uint64_t journals = 0;
  uint64_t frames = 0;  ///< Whole ones in journals.
  uint64_t entities = 0;
  uint64_t snapshots = 0;  ///< In segments; those with several forms count as often.
  uint64_t instances = 0;  ///< Of these.
  uint64_t media = 0;      ///< Of these.
  uint64_t bytes = 0;      ///< Of all files.
  std::vector<Finding> findings;

  [[nodiscard]] uint64_t faults() const;
  [[nodiscard]] bool is_clean() const { return faults() == 0; }
};

/// Reads a store whole and says what is wrong with it. Changes nothing; memory is bounded by the
/// largest journal. Beside a live writer, one generation is checked.
///
/// Errors: kNotFound where there is no store; kFailedPrecondition where its format is newer;
/// kUnavailable; kCancelled.
/// Source: docs/format.md, section "Checking and recovering".
Result<CheckReport> check_store(const std::filesystem::path& store,
                                const CheckOptions& options = {}, const ProgressSink& progress = {},
                                const std::stop_token& stop = {});

}  // namespace engram::ltm
