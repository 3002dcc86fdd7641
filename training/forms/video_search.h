// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::training {

/// The smallest video of some images in which every image keeps a bound.
struct FoundVideo {
  std::vector<std::byte> bytes;
  std::string codec;        ///< Name of the codec.
  double quality = 0;       ///< Its crf; 0 if lossless.
  std::vector<double> mse;  ///< Per image. Unit: grey levels squared.
};

/// Searches for the quality that a group codec needs to keep a bound. Each search starts at the
/// result of the last one, because consecutive runs of images need similar qualities.
///
/// Threading: one thread.
class VideoSearch {
 public:
  /// `codec` is "av1", "h265" or "h264". `effort` is the option of the codec.
  VideoSearch(std::string codec, int effort, double bound_db);

  /// Returns the smaller result of find_lossy() and find_lossless(), or nothing if no installed
  /// codec accepts such images.
  /// Errors: the errors of the codecs.
  Result<std::optional<FoundVideo>> find(std::span<const idf::NdArray> images);

  /// Encodes with the worst quality that keeps the bound. The result is empty if no quality keeps
  /// it or the codec does not accept such images.
  Result<std::optional<FoundVideo>> find_lossy(std::span<const idf::NdArray> images);

  /// Encodes with FFV1. The result is empty if it is not installed or does not accept such images.
  Result<std::optional<FoundVideo>> find_lossless(std::span<const idf::NdArray> images) const;

 private:
  Result<FoundVideo> encode(std::span<const idf::NdArray> images, const std::string& codec) const;
  [[nodiscard]] bool is_within(const FoundVideo& video) const;

  std::string codec_;
  int effort_;
  double bound_db_;
  int max_crf_;
  int crf_;  ///< Result of the last search.
};

}  // namespace engram::training
