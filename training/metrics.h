// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/store/latent.h"

namespace engram::training {

/// Where the PSNR of a single image ends: two equal images have no finite one.
inline constexpr double kLargestPsnrDb = 60.0;

/// Peak signal-to-noise ratio of 8-bit images. Unit: dB, at most kLargestPsnrDb.
/// `mse` in grey levels squared; not a number stays so.
[[nodiscard]] double psnr_db(double mse);

/// How far `other` is from `recorded`, over the tensor members of their layout.
///
/// Images of 16 bits count in grey levels, 255 for the largest value of the recorded one. Numbers
/// that are not finite must be equal; else the error is infinite.
/// Errors: kInvalidArgument where the two have different layouts.
Result<ltm::MeasuredError> compare(const idf::Data& recorded, const idf::Data& other);

/// PSNR of many images in both conventions; they differ where quality varies.
///
/// Threading: one thread.
class PsnrStatistics {
 public:
  /// Not a number is left out.
  void add(double mse);

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

/// Root mean squared error of many values of equal size.
///
/// Threading: one thread.
class RmseStatistics {
 public:
  /// Not a number is left out.
  void add(double mse);

  [[nodiscard]] uint64_t count() const { return count_; }
  [[nodiscard]] double rmse() const;  ///< NaN where there are no values.

 private:
  double mse_sum_ = 0;
  uint64_t count_ = 0;
};

}  // namespace engram::training
