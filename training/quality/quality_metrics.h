// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/store/latent.h"
#include "training/quality/psnr.h"

namespace engram::training {

/// Errors of `other` relative to `recorded`, over the tensor members of their layout.
///
/// Errors of 16-bit images are in grey levels, where 255 is the largest value of the recorded
/// image. If numbers that are not finite differ, the error is infinite.
/// Errors: kInvalidArgument if the layouts differ.
Result<ltm::MeasuredError> compare(const idf::Data& recorded, const idf::Data& other);

/// The same for a prediction: bools and the members at the paths `uncounted` are left out, because
/// they are only ever copied, and two unit quaternions (four floats) are compared as rotations,
/// whatever their signs.
/// Errors: kInvalidArgument if the layouts differ.
Result<ltm::MeasuredError> compare_prediction(const idf::Data& recorded, const idf::Data& predicted,
                                              const std::vector<std::string>& uncounted = {});

/// Mean structural similarity (quality/ssim.h) of the 8-bit images among their tensor members; NaN
/// if none is at least 11 pixels wide and high.
/// Errors: kInvalidArgument if the layouts differ.
Result<double> mean_ssim(const idf::Data& recorded, const idf::Data& other);

/// Mean squared error of two 8-bit or 16-bit images, in grey levels squared as in compare().
/// Errors: kInvalidArgument if types or shapes differ.
Result<double> grey_mse(const idf::NdArray& recorded, const idf::NdArray& other);

/// Root mean squared error of many values of equal size.
///
/// Threading: one thread.
class RmseStatistics {
 public:
  /// Adds an error. NaN is left out.
  void add(double mse);
  void add(const RmseStatistics& more);

  [[nodiscard]] uint64_t count() const { return count_; }
  [[nodiscard]] double rmse() const;  ///< NaN without values.

 private:
  double mse_sum_ = 0;
  uint64_t count_ = 0;
};

}  // namespace engram::training
