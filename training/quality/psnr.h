// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::training {

/// Max PSNR of a single image. Two equal images would have an infinite one.
inline constexpr double kLargestPsnrDb = 60.0;

/// Peak signal-to-noise ratio of 8-bit images. Unit: dB, at most kLargestPsnrDb. `mse` is in grey
/// levels squared; for NaN the result is NaN.
[[nodiscard]] double psnr_db(double mse);

/// The mean squared error of an image with this PSNR, which is in dB. Unit: grey levels squared.
[[nodiscard]] double mse_of_psnr(double db);

/// Whether images that were told to have the error `told_mse` have it, or NaN because there are
/// none. Another processor may round the output of a network differently, by at most one grey
/// level.
[[nodiscard]] bool is_as_told(double found_mse, double told_mse);

/// Mean squared error of two images. Unit: grey levels squared.
/// Shape: uint8 [H, W, C], equal for both.
/// Errors: kInvalidArgument if type or shape is another one.
Result<double> image_mse(const idf::NdArray& recorded, const idf::NdArray& other);

/// The same over those pixels that differ from the previous recorded image in any channel by more
/// than `threshold` grey levels. NaN if there are none.
/// Errors: kInvalidArgument if the three images differ in type or shape.
Result<double> moving_mse(const idf::NdArray& before, const idf::NdArray& recorded,
                          const idf::NdArray& other, int threshold = 8);

/// PSNR of many images in both conventions, which differ if quality varies.
///
/// Threading: one thread.
class PsnrStatistics {
 public:
  /// Adds an error. NaN is left out.
  void add(double mse);
  void add(const PsnrStatistics& more);

  [[nodiscard]] uint64_t count() const { return values_db_.size(); }
  /// Images whose PSNR was capped at kLargestPsnrDb.
  [[nodiscard]] uint64_t capped() const { return capped_; }

  // All are NaN without images.
  [[nodiscard]] double mean_db() const;    ///< Mean over the images' PSNR.
  [[nodiscard]] double pooled_db() const;  ///< PSNR of the mean squared error.
  [[nodiscard]] double minimum_db() const;
  /// The quantile of the PSNR at `share` (0 to 1), interpolated.
  [[nodiscard]] double quantile_db(double share) const;

 private:
  std::vector<double> values_db_;
  double mse_sum_ = 0;
  uint64_t capped_ = 0;
};

}  // namespace engram::training
