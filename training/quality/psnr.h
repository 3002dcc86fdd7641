// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::training {

/// Where the PSNR of a single image ends: two equal images have no finite one.
inline constexpr double kLargestPsnrDb = 60.0;

/// Peak signal-to-noise ratio of 8-bit images. Unit: dB, at most kLargestPsnrDb.
/// `mse` in grey levels squared; not a number stays so.
[[nodiscard]] double psnr_db(double mse);

/// Mean squared error of two images. Unit: grey levels squared.
/// Shape: uint8 [H, W, C], both alike. Errors: kInvalidArgument where they are not.
Result<double> image_mse(const idf::NdArray& recorded, const idf::NdArray& other);

/// The same over those pixels that changed against the recorded image before: in any channel by
/// more than `threshold` grey levels. Not a number where none did.
/// Errors: kInvalidArgument where the three are not alike.
Result<double> moving_mse(const idf::NdArray& before, const idf::NdArray& recorded,
                          const idf::NdArray& other, int threshold = 8);

/// PSNR of many images in both conventions; they differ where quality varies.
///
/// Threading: one thread.
class PsnrStatistics {
 public:
  /// Not a number is left out.
  void add(double mse);
  void add(const PsnrStatistics& more);

  [[nodiscard]] uint64_t count() const { return values_db_.size(); }
  /// Images whose PSNR was capped at kLargestPsnrDb.
  [[nodiscard]] uint64_t capped() const { return capped_; }

  // NaN where there are no images.
  [[nodiscard]] double mean_db() const;    ///< Mean over the images' PSNR.
  [[nodiscard]] double pooled_db() const;  ///< PSNR of the mean squared error.
  [[nodiscard]] double minimum_db() const;
  /// The value that a share of the images is below, 0 to 1; interpolated.
  [[nodiscard]] double quantile_db(double share) const;

 private:
  std::vector<double> values_db_;
  double mse_sum_ = 0;
  uint64_t capped_ = 0;
};

}  // namespace engram::training
