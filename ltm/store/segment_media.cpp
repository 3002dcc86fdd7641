// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_media.h"

#include <algorithm>
#include <map>
#include <set>

#include "ltm/store/segment_format.h"

namespace engram::ltm {

namespace {

Status write_header(h5::File& file, const std::string& name, const std::string& path,
                    const std::string& codec, idf::ElementType type) {
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(name, "path", path));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(name, "codec", codec));
  return file.write_attribute(name, "element_type", to_string(type));
}

/// Generates the names of media groups.
class MediaNames {
 public:
  MediaNames(std::string group, const std::set<std::string>& paths)
      : group_(std::move(group)), paths_(paths) {}

  /// The next name for media at `path`.
  std::string next(const std::string& path) {
    const int number = numbers_[path]++;
    std::string name = group_ + "/media" + segment_member(path);
    // A number is also needed if other media lie below this path, because their groups would be
    // placed among the datasets of this one.
    if (number > 0 || has_media_below(path)) name += fmt::format("#{}", number);
    names_.push_back(name);
    return name;
  }

  [[nodiscard]] const std::vector<std::string>& all() const { return names_; }

 private:
  [[nodiscard]] bool has_media_below(const std::string& path) const {
    const auto below = paths_.lower_bound(path + '/');
    return below != paths_.end() && below->starts_with(path + '/');
  }

  std::string group_;
  const std::set<std::string>& paths_;
  std::map<std::string, int> numbers_;
  std::vector<std::string> names_;
};

// An HDF5 group has one codec, one element type and shapes of one rank, so media that differ in
// these from the first at their path get a column of their own.
std::vector<MediaColumn> columns_of(const std::vector<RowMedium>& media) {
  std::vector<MediaColumn> columns;
  for (const RowMedium& each : media) {
    auto column = std::ranges::find_if(
        columns, [&](const MediaColumn& known) { return known.fits(each.medium); });
    if (column == columns.end()) column = columns.insert(column, MediaColumn(each.medium));
    column->append(each);
  }
  return columns;
}

}  // namespace

bool MediaColumn::fits(const PackedMedium& medium) const {
  return path_ == medium.path && codec_ == medium.codec && type_ == medium.type &&
         shape_.size() == medium.shape.size();
}

void MediaColumn::append(const RowMedium& added) {
  fill(added.row);
  blobs_.append(added.medium.bytes.bytes());
  shapes_.insert(shapes_.end(), added.medium.shape.begin(), added.medium.shape.end());
  has_one_shape_ = has_one_shape_ && added.medium.shape == shape_;
  ++rows_;
}

/// Adds an empty blob for each row without this medium.
void MediaColumn::fill(size_t until) {
  for (; rows_ < until; ++rows_) {
    blobs_.append({});
    shapes_.insert(shapes_.end(), shape_.begin(), shape_.end());
  }
}

Status MediaColumn::write(h5::File& file, const std::string& name, size_t rows) {
  fill(rows);
  ENGRAM_RETURN_IF_ERROR(blobs_.write(file, name));
  ENGRAM_RETURN_IF_ERROR(write_header(file, name, path_, codec_, type_));
  return write_shapes(file, name + "/shape");
}

Status MediaColumn::write_shapes(h5::File& file, const std::string& dataset) const {
  if (has_one_shape_) return write_column(file, dataset, shape_);
  const std::vector<uint64_t> size{rows_, shape_.size()};
  return file.write(dataset, h5::Type::kInt64, size, std::as_bytes(std::span(shapes_)),
                    h5::Storage::kCompressed);
}

void GroupColumn::append(std::span<const std::byte> group, std::span<const uint64_t> rows) {
  blobs_.append(group);
  rows_.insert(rows_.end(), rows.begin(), rows.end());
  first_images_.push_back(rows_.size());
}

Status GroupColumn::write(h5::File& file, const std::string& name, size_t rows) const {
  ENGRAM_RETURN_IF_ERROR(blobs_.write(file, name));
  ENGRAM_RETURN_IF_ERROR(write_header(file, name, path_, codec_, type_));
  ENGRAM_RETURN_IF_ERROR(write_column(file, name + "/shape", shape_));
  ENGRAM_RETURN_IF_ERROR(write_column(file, name + "/first_image", first_images_));
  // If every row has an image, image i is that of row i and `row` is not needed.
  return rows_.size() == rows ? Status() : write_column(file, name + "/row", rows_);
}

Status write_media(h5::File& file, const std::string& group, const SortedMedia& media,
                   size_t rows) {
  std::vector<MediaColumn> columns = columns_of(media.single);
  std::set<std::string> paths;
  for (const MediaColumn& column : columns) paths.insert(column.path());
  for (const GroupColumn& column : media.groups) paths.insert(column.path());
  MediaNames names(group, paths);
  for (const GroupColumn& column : media.groups)
    ENGRAM_RETURN_IF_ERROR(column.write(file, names.next(column.path()), rows));
  for (MediaColumn& column : columns)
    ENGRAM_RETURN_IF_ERROR(column.write(file, names.next(column.path()), rows));
  return names.all().empty() ? Status() : file.write_strings(group + "/media_groups", names.all());
}

}  // namespace engram::ltm
