// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment reader.

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/store/segment_source.h"

namespace engram::ltm {

/// Reads the media of rows in stored form. Images of one encoded group share its bytes. The group
/// read last of each media group is kept.
///
/// Threading: one thread. The source must outlive it.
/// Source: docs/format.md, "Media".
class SegmentMediaReader {
 public:
  explicit SegmentMediaReader(SegmentSource& source) : source_(source) {}

  /// The media of one row of the entity.
  /// Errors: kDataLoss.
  Result<std::vector<PackedMedium>> media(const std::string& group, uint64_t row);

  /// The names of the codecs with which the entity's media are stored.
  /// Errors: kDataLoss.
  Result<std::set<std::string>> codecs(const std::string& group);

  /// True if images of any medium of the entity are stored in groups.
  /// Errors: kDataLoss.
  Result<bool> has_groups(const std::string& group);

 private:
  struct MediaGroup {
    std::string name;
    PackedMedium medium;  ///< Has no bytes, and no shape if each row has its own.
    bool has_shapes = false;
    bool has_groups = false;  ///< True for groups of images; otherwise there is one medium per row.
    uint64_t last_group = UINT64_MAX;  ///< Number of the group in `last_bytes`.
    Buffer last_bytes;
  };

  Result<std::vector<MediaGroup>*> groups_of(const std::string& group);
  Result<MediaGroup> open(const std::string& name);
  Result<std::optional<PackedMedium>> single(const MediaGroup& found, uint64_t row);
  Result<std::optional<PackedMedium>> of_group(MediaGroup& found, uint64_t row);
  Result<std::optional<uint64_t>> image_of(const MediaGroup& found, uint64_t images, uint64_t row);
  Result<uint64_t> last_not_above(const std::string& path, uint64_t count, uint64_t value);
  Result<idf::Shape> shape(const std::string& path, uint64_t row);

  SegmentSource& source_;
  std::map<std::string, std::vector<MediaGroup>> groups_;
};

}  // namespace engram::ltm
