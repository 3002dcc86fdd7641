// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/store/store_reader.h"

namespace engram::training {

/// The path that an image took to its stored form.
enum class KeptForm {
  kLatents,   ///< As the encoder made them.
  kRefined,   ///< Latents that were searched for.
  kResidual,  ///< Latents, refined or not, and what they lack.
  kVideo,
  kLossless,
};

[[nodiscard]] std::string_view to_string(KeptForm form);

/// One image member of a snapshot's instance.
struct StoredImage {
  std::string member;  ///< Its path.
  KeptForm form = KeptForm::kLatents;
  /// An even share of what its block holds of this member, and all of its own residual.
  double bytes = 0;
  uint64_t residual_bytes = 0;
};

/// One snapshot as the offline phase keeps it.
struct StoredSnapshot {
  Time time{};
  int model_version = 0;
  std::vector<StoredImage> images;  ///< Of all instances.
  /// Images, an even share of what else is in the blocks (numbers, heads, checksums), and the
  /// remainders; without the segment around them.
  double bytes = 0;
  double psnr_db = 0;  ///< Of all its images together, as it was measured; NaN without images.
  double rmse = 0;     ///< Of all its numbers together, likewise; NaN without numbers.
};

/// Tells of every snapshot of an entity that has latents how it is kept, in the order of time.
/// Decodes nothing; blocks say it themselves.
/// Errors: kNotFound; kDataLoss; those of the store and of `sink`.
Status list_stored_snapshots(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                             const std::function<Status(const StoredSnapshot&)>& sink);

}  // namespace engram::training
