// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "ltm/idf/data.h"
#include "ltm/store/latent.h"
#include "training/quality/psnr.h"

namespace engram::training {

/// How far `other` is from `recorded`, over the tensor members of their layout.
///
/// Images of 16 bits count in grey levels, 255 for the largest value of the recorded one. Numbers
/// that are not finite must be equal; else the error is infinite.
/// Errors: kInvalidArgument where the two have different layouts.
Result<ltm::MeasuredError> compare(const idf::Data& recorded, const idf::Data& other);

/// The same of a prediction, which is not blamed for what nobody predicts: bools are left out, and
/// a unit quaternion (four floats) is the rotation that it says, whatever its sign. Errors:
/// kInvalidArgument where the two have different layouts.
Result<ltm::MeasuredError> compare_prediction(const idf::Data& recorded,
                                              const idf::Data& predicted);

/// Mean structural similarity (quality/ssim.h) of the images of 8 bits among their tensor members;
/// NaN where none is at least 11 pixels wide and high.
/// Errors: kInvalidArgument where the two have different layouts.
Result<double> mean_ssim(const idf::Data& recorded, const idf::Data& other);

/// Mean squared error of two images alike, of 8 or 16 bits, in grey levels as compare() counts
/// them. Errors: kInvalidArgument where they are not alike.
Result<double> grey_mse(const idf::NdArray& recorded, const idf::NdArray& other);

/// Root mean squared error of many values of equal size.
///
/// Threading: one thread.
class RmseStatistics {
 public:
  /// Not a number is left out.
  void add(double mse);
  void add(const RmseStatistics& more);

  [[nodiscard]] uint64_t count() const { return count_; }
  [[nodiscard]] double rmse() const;  ///< NaN where there are no values.

 private:
  double mse_sum_ = 0;
  uint64_t count_ = 0;
};

}  // namespace engram::training
