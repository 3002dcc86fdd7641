// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment writer.

#include <string>
#include <unordered_map>
#include <vector>

#include "ltm/h5/h5.h"
#include "ltm/store/packed_snapshot.h"

namespace engram::ltm {

/// A row of a recorded entity: one instance of a snapshot. The snapshot must outlive it.
struct SegmentRow {
  const PackedSnapshot* snapshot;
  size_t instance;

  [[nodiscard]] const PackedInstance& packed() const { return snapshot->instances[instance]; }
};

/// The columns that rows of all kinds have: time, instance and metadata.
class RowColumns {
 public:
  void append(Time time, size_t instance, const InstanceMetadata& metadata);

  /// Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& group) const;

  [[nodiscard]] size_t rows() const { return timestamps_.size(); }

 private:
  /// Writes nothing if no row is augmented.
  Status write_augmented(h5::File& file, const std::string& metadata) const;

  /// Writes nothing if `times` are equal to the times of the snapshots.
  Status write_times(h5::File& file, const std::string& path,
                     const std::vector<int64_t>& times) const;

  std::vector<int64_t> timestamps_, created_, sent_, arrived_;
  std::vector<int32_t> instances_, provider_;
  std::vector<float> confidences_;
  std::vector<std::string> providers_;
  std::unordered_map<std::string, size_t> provider_index_;
  /// Entries up to the last augmented row; empty for rows that are not augmented.
  std::vector<std::string> origins_, recipes_;
};

/// What the online filters did, as columns. The figures of a snapshot are in its first row.
class AccountingColumns {
 public:
  void append(const SegmentRow& row);

  /// Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& group) const;

 private:
  std::vector<uint64_t> raw_bytes_, dropped_, dropped_bytes_;
};

}  // namespace engram::ltm
