// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment writer.

#include <span>
#include <string>
#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/store/segment_blobs.h"

namespace engram::ltm {

/// A medium of one row.
struct RowMedium {
  size_t row = 0;
  PackedMedium medium;
};

/// Media that are stored row by row. Each path has one group per variant of codec, type and number
/// of axes.
///
/// Source: docs/format.md, "Media".
class MediaColumn {
 public:
  explicit MediaColumn(const PackedMedium& first)
      : path_(first.path), codec_(first.codec), type_(first.type), shape_(first.shape) {}

  [[nodiscard]] const std::string& path() const { return path_; }

  /// True if a medium belongs to this variant.
  [[nodiscard]] bool fits(const PackedMedium& medium) const;

  /// Adds the medium of a row. Rows must ascend; rows without this medium are left out.
  void append(const RowMedium& added);

  /// Writes the media of `rows` rows. Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& name, size_t rows);

 private:
  void fill(size_t until);
  Status write_shapes(h5::File& file, const std::string& dataset) const;

  std::string path_;
  std::string codec_;
  idf::ElementType type_;
  idf::Shape shape_;  ///< Shape of the first medium.
  BlobColumn blobs_;
  std::vector<int64_t> shapes_;  ///< Row-major [rows, rank].
  size_t rows_ = 0;
  bool has_one_shape_ = true;
};

/// Media that are stored as groups of images of one path, codec, type and shape.
///
/// Source: docs/format.md, "Groups of images".
class GroupColumn {
 public:
  GroupColumn(std::string path, std::string codec, idf::ElementType type, idf::Shape shape)
      : path_(std::move(path)), codec_(std::move(codec)), type_(type), shape_(std::move(shape)) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& codec() const { return codec_; }

  /// Adds a group with one image for each of `rows`. Rows must ascend, also from group to group.
  void append(std::span<const std::byte> group, std::span<const uint64_t> rows);

  /// Writes the groups; the entity has `rows` rows. Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& name, size_t rows) const;

 private:
  std::string path_;
  std::string codec_;
  idf::ElementType type_;
  idf::Shape shape_;
  BlobColumn blobs_;
  std::vector<uint64_t> first_images_{0};
  std::vector<uint64_t> rows_;
};

/// The media of an entity, sorted by how they are stored.
struct SortedMedia {
  std::vector<GroupColumn> groups;
  std::vector<RowMedium> single;  ///< In the order of rows.
};

/// Writes the media of an entity of `rows` rows. Errors: those of h5::File::write.
Status write_media(h5::File& file, const std::string& group, const SortedMedia& media, size_t rows);

}  // namespace engram::ltm
