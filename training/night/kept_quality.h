// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "encoders/provenance.h"

// Private to this room.

namespace engram::training {

/// Quality and size of encoded snapshots. The members are as in EntityReport.
struct KeptQuality {
  uint64_t snapshots = 0;
  uint64_t raw_bytes = 0;
  uint64_t latent_bytes = 0;
  double mean_psnr_db = 0;
  double pooled_psnr_db = 0;
  double minimum_psnr_db = 0;
  std::array<double, 3> psnr_quantiles_db{};
  double rmse = 0;
  encoders::StoredForms forms;
};

}  // namespace engram::training
