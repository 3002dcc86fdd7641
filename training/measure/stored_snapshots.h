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

/// The form in which an image is stored.
enum class KeptForm {
  kLatents,   ///< Latents from the encoder.
  kRefined,   ///< Refined latents.
  kResidual,  ///< Latents, refined or not, with a residual.
  kVideo,
  kLossless,
  kGist,  ///< What remains of old images (encoders/gist_video.h).
};

[[nodiscard]] std::string_view to_string(KeptForm form);

/// One image member of a snapshot's instance.
struct StoredImage {
  std::string member;  ///< Path of the member.
  KeptForm form = KeptForm::kLatents;
  /// An even share of the bytes of this member in its block, and all of its own residual.
  double bytes = 0;
  uint64_t residual_bytes = 0;
};

/// The stored form of one snapshot.
struct StoredSnapshot {
  Time time{};
  int model_version = 0;
  std::vector<StoredImage> images;  ///< Of all instances.
  /// Images, an even share of the other bytes of the blocks (numbers, heads, checksums), and the
  /// remainders, without the segment around them.
  double bytes = 0;
  double psnr_db = 0;  ///< Measured over all its images; NaN without images.
  double rmse = 0;     ///< Measured over all its numbers; NaN without numbers.
};

/// Calls `sink` for every snapshot of an entity that has latents, in the order of time. It reads
/// the heads of blocks and decodes nothing.
/// Errors: kNotFound; kDataLoss; the errors of the store and of `sink`.
Status list_stored_snapshots(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                             const std::function<Status(const StoredSnapshot&)>& sink);

}  // namespace engram::training
