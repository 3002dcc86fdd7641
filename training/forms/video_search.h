// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::training {

/// The smallest video of some images whose every image is within a bound.
struct FoundVideo {
  std::vector<std::byte> bytes;
  std::string codec;        ///< Its name.
  double quality = 0;       ///< Its crf; 0 without loss.
  std::vector<double> mse;  ///< Of each image. Unit: grey levels squared.
};

/// Searches the quality that a group codec needs to keep a bound, from one run of images to the
/// next: it starts where it ended before.
///
/// Threading: one thread.
class VideoSearch {
 public:
  /// `codec`: "av1", "h265" or "h264". `effort` as of the codec.
  VideoSearch(std::string codec, int effort, double bound_db);

  /// The smaller of both below; nothing where no installed codec takes such images.
  /// Errors: those of the codecs.
  Result<std::optional<FoundVideo>> find(std::span<const idf::NdArray> images);

  /// The worst quality that keeps the bound; nothing where none does, or the codec does not take
  /// such images.
  Result<std::optional<FoundVideo>> find_lossy(std::span<const idf::NdArray> images);

  /// FFV1.
  Result<std::optional<FoundVideo>> find_lossless(std::span<const idf::NdArray> images) const;

 private:
  Result<FoundVideo> encode(std::span<const idf::NdArray> images, const std::string& codec) const;
  [[nodiscard]] bool is_within(const FoundVideo& video) const;

  std::string codec_;
  int effort_;
  double bound_db_;
  int max_crf_;
  int crf_;  ///< Where the last search ended.
};

}  // namespace engram::training
