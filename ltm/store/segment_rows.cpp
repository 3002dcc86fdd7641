// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_rows.h"

#include <algorithm>

#include "ltm/store/segment_blobs.h"

namespace engram::ltm {

namespace {

/// Writes figures, or nothing if all are zero.
Status write_figures(h5::File& file, const std::string& path,
                     const std::vector<uint64_t>& figures) {
  const bool is_any = std::ranges::any_of(figures, [](uint64_t figure) { return figure != 0; });
  return is_any ? write_row_column(file, path, figures) : Status();
}

}  // namespace

void RowColumns::append(Time time, size_t instance, const InstanceMetadata& metadata) {
  timestamps_.push_back(to_ns(time));
  instances_.push_back(static_cast<int32_t>(instance));
  created_.push_back(to_ns(metadata.created));
  sent_.push_back(to_ns(metadata.sent));
  arrived_.push_back(to_ns(metadata.arrived));
  confidences_.push_back(metadata.confidence);
  const auto [known, is_new] = provider_index_.emplace(metadata.provider, providers_.size());
  if (is_new) providers_.push_back(metadata.provider);
  provider_.push_back(static_cast<int32_t>(known->second));
  if (!metadata.is_augmented()) return;
  origins_.resize(rows());
  recipes_.resize(rows());
  origins_.back() = metadata.origin.to_string();
  recipes_.back() = metadata.recipe;
}

Status RowColumns::write(h5::File& file, const std::string& group) const {
  const std::string metadata = group + "/metadata";
  ENGRAM_RETURN_IF_ERROR(write_column(file, group + "/timestamp", timestamps_));
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, group + "/instance", instances_));
  ENGRAM_RETURN_IF_ERROR(write_times(file, metadata + "/created", created_));
  ENGRAM_RETURN_IF_ERROR(write_times(file, metadata + "/sent", sent_));
  ENGRAM_RETURN_IF_ERROR(write_times(file, metadata + "/arrived", arrived_));
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, metadata + "/confidence", confidences_));
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, metadata + "/provider", provider_));
  ENGRAM_RETURN_IF_ERROR(write_augmented(file, metadata));
  return file.write_strings(metadata + "/providers", providers_);
}

Status RowColumns::write_augmented(h5::File& file, const std::string& metadata) const {
  if (recipes_.empty()) return {};
  ENGRAM_RETURN_IF_ERROR(file.write_strings(metadata + "/origin", origins_));
  return file.write_strings(metadata + "/recipe", recipes_);
}

Status RowColumns::write_times(h5::File& file, const std::string& path,
                               const std::vector<int64_t>& times) const {
  return times == timestamps_ ? Status() : write_row_column(file, path, times);
}

void AccountingColumns::append(const SegmentRow& row) {
  const bool is_first = row.instance == 0;
  raw_bytes_.push_back(is_first ? row.snapshot->raw_bytes : 0);
  dropped_.push_back(is_first ? row.snapshot->dropped : 0);
  dropped_bytes_.push_back(is_first ? row.snapshot->dropped_bytes : 0);
}

Status AccountingColumns::write(h5::File& file, const std::string& group) const {
  ENGRAM_RETURN_IF_ERROR(write_figures(file, group + "/accounting/raw_bytes", raw_bytes_));
  ENGRAM_RETURN_IF_ERROR(write_figures(file, group + "/accounting/dropped", dropped_));
  return write_figures(file, group + "/accounting/dropped_bytes", dropped_bytes_);
}

}  // namespace engram::ltm
