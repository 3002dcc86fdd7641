// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "datasets/vault/vault_export.h"

namespace engram::datasets::vault {

struct VaultCheckReport {
  bool had_keys = false;  ///< Without keys only the structure of files was checked.
  uint64_t files = 0;     ///< Files that were checked.
  uint64_t bytes = 0;
  uint64_t snapshots = 0;    ///< Read and in order; 0 without keys.
  uint64_t destroyed = 0;    ///< Days whose keys were destroyed.
  uint64_t remains = 0;      ///< Files of these that are still there. Nobody can read them.
  uint64_t without_key = 0;  ///< Whole files that the key file does not know.
  std::vector<VaultFinding> damaged;

  [[nodiscard]] bool is_whole() const { return damaged.empty(); }
};

/// Decrypts and checks all files of a vault, and changes nothing. An empty `places.keys`: without
/// keys.
/// Errors: those of read_keys_of; kCancelled after a stop.
Result<VaultCheckReport> check_vault(const VaultPlaces& places, const ProgressSink& progress,
                                     const std::stop_token& stop);

}  // namespace engram::datasets::vault
