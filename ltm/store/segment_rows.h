// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what segment files are written of.

#include <string>
#include <unordered_map>
#include <vector>

#include "ltm/h5/h5.h"
#include "ltm/store/packed_snapshot.h"

namespace engram::ltm {

/// A row of a recorded entity: one instance of a snapshot, which must outlive it.
struct SegmentRow {
  const PackedSnapshot* snapshot;
  size_t instance;

  [[nodiscard]] const PackedInstance& packed() const { return snapshot->instances[instance]; }
};

/// Columns that rows of every kind share: time, instance and metadata.
class RowColumns {
 public:
  void append(Time time, size_t instance, const InstanceMetadata& metadata);

  /// Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& group) const;

  [[nodiscard]] size_t rows() const { return timestamps_.size(); }

 private:
  /// Nothing where no row is augmented.
  Status write_augmented(h5::File& file, const std::string& metadata) const;

  /// Nothing where they are the times of the snapshots.
  Status write_times(h5::File& file, const std::string& path,
                     const std::vector<int64_t>& times) const;

  std::vector<int64_t> timestamps_, created_, sent_, arrived_;
  std::vector<int32_t> instances_, provider_;
  std::vector<float> confidences_;
  std::vector<std::string> providers_;
  std::unordered_map<std::string, size_t> provider_index_;
  /// Up to the last augmented row, empty where a row is not.
  std::vector<std::string> origins_, recipes_;
};

/// What the online filters did, per row; a snapshot's figures stand at its first row.
class AccountingColumns {
 public:
  void append(const SegmentRow& row);

  /// Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& group) const;

 private:
  std::vector<uint64_t> raw_bytes_, dropped_, dropped_bytes_;
};

}  // namespace engram::ltm
