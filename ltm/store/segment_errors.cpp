// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ltm/store/segment_blobs.h"

namespace engram::ltm {

namespace {

constexpr double kNoBound = std::numeric_limits<double>::quiet_NaN();

Status write_bounds(h5::File& segment, const std::string& path, const std::vector<double>& bounds) {
  const bool is_any = std::ranges::any_of(bounds, [](double bound) { return !std::isnan(bound); });
  return is_any ? write_row_column(segment, path, bounds) : Status();
}

/// A number of a row of a column that not all segments have.
template <typename T>
Result<T> optional_number(SegmentSource& source, const std::string& path, uint64_t row, T absent) {
  ENGRAM_ASSIGN_OR_RETURN(const SegmentColumn* column, source.column_if_there(path));
  if (column == nullptr) return absent;
  return source.row_number<T>(path, row);
}

}  // namespace

void ErrorColumns::append(const LatentQuality& quality) {
  const MeasuredError bound = quality.bound.value_or(MeasuredError{});
  image_mse_.push_back(quality.error.image_mse);
  number_mse_.push_back(quality.error.number_mse);
  image_bound_.push_back(bound.image_mse);
  number_bound_.push_back(bound.number_mse);
  faded_to_db_.push_back(quality.faded_to_db);
}

Status ErrorColumns::write(h5::File& file, const std::string& group) const {
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, group + "/error/image_mse", image_mse_));
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, group + "/error/number_mse", number_mse_));
  ENGRAM_RETURN_IF_ERROR(write_bounds(file, group + "/error/image_bound", image_bound_));
  ENGRAM_RETURN_IF_ERROR(write_bounds(file, group + "/error/number_bound", number_bound_));
  const bool is_any = std::ranges::any_of(
      faded_to_db_, [](float psnr_db) { return psnr_db != LatentQuality::kNotFaded; });
  return is_any ? write_row_column(file, group + "/faded_to", faded_to_db_) : Status();
}

Result<LatentQuality> read_quality(SegmentSource& source, const std::string& group, uint64_t row) {
  LatentQuality quality;
  ENGRAM_ASSIGN_OR_RETURN(quality.error.image_mse,
                          source.row_number<double>(group + "/error/image_mse", row));
  ENGRAM_ASSIGN_OR_RETURN(quality.error.number_mse,
                          source.row_number<double>(group + "/error/number_mse", row));
  MeasuredError bound;
  ENGRAM_ASSIGN_OR_RETURN(
      bound.image_mse,
      optional_number<double>(source, group + "/error/image_bound", row, kNoBound));
  ENGRAM_ASSIGN_OR_RETURN(
      bound.number_mse,
      optional_number<double>(source, group + "/error/number_bound", row, kNoBound));
  if (!std::isnan(bound.image_mse) || !std::isnan(bound.number_mse)) quality.bound = bound;
  ENGRAM_ASSIGN_OR_RETURN(
      quality.faded_to_db,
      optional_number<float>(source, group + "/faded_to", row, LatentQuality::kNotFaded));
  if (quality.faded_to_db >= 0) return quality;
  return source.broken(group + "/faded_to",
                       fmt::format("row {} faded to {} dB", row, quality.faded_to_db));
}

}  // namespace engram::ltm
