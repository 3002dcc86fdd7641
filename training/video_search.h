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
/// next: it starts where it ended before. Where no quality is enough, and for images that the codec
/// does not take, FFV1 keeps them without loss.
///
/// Threading: one thread.
class VideoSearch {
 public:
  /// `codec`: "av1", "h265" or "h264". `effort` as of the codec.
  VideoSearch(std::string codec, int effort, double bound_db);

  /// Nothing where no installed codec takes such images.
  /// Errors: those of the codecs.
  Result<std::optional<FoundVideo>> find(std::span<const idf::NdArray> images);

 private:
  Result<FoundVideo> encode(std::span<const idf::NdArray> images, const std::string& codec) const;
  Result<std::optional<FoundVideo>> find_lossless(std::span<const idf::NdArray> images) const;
  Result<std::optional<FoundVideo>> find_lossy(std::span<const idf::NdArray> images);
  [[nodiscard]] bool is_within(const FoundVideo& video) const;

  std::string codec_;
  int effort_;
  double bound_db_;
  int most_crf_;
  int crf_;  ///< Where the last search ended.
};

}  // namespace engram::training
