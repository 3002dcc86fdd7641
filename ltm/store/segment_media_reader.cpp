// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_media_reader.h"

#include <algorithm>

namespace engram::ltm {

Result<std::vector<PackedMedium>> SegmentMediaReader::media(const std::string& group,
                                                            uint64_t row) {
  std::vector<PackedMedium> media;
  ENGRAM_ASSIGN_OR_RETURN(auto* groups, groups_of(group));
  for (MediaGroup& found : *groups) {
    ENGRAM_ASSIGN_OR_RETURN(auto medium,
                            found.has_groups ? of_group(found, row) : single(found, row));
    if (medium) media.push_back(*std::move(medium));
  }
  return media;
}

Result<std::set<std::string>> SegmentMediaReader::codecs(const std::string& group) {
  std::set<std::string> names;
  ENGRAM_ASSIGN_OR_RETURN(const auto* groups, groups_of(group));
  for (const MediaGroup& found : *groups) names.insert(found.medium.codec);
  return names;
}

Result<bool> SegmentMediaReader::has_groups(const std::string& group) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* groups, groups_of(group));
  return std::ranges::any_of(*groups, &MediaGroup::has_groups);
}

Result<std::optional<PackedMedium>> SegmentMediaReader::single(const MediaGroup& found,
                                                               uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(Buffer bytes, source_.blob(found.name, row));
  if (bytes.empty()) return std::optional<PackedMedium>();
  PackedMedium medium = found.medium;
  medium.bytes = std::move(bytes);
  if (found.has_shapes) {
    ENGRAM_ASSIGN_OR_RETURN(medium.shape, shape(found.name + "/shape", row));
  }
  return std::optional(std::move(medium));
}

Result<std::optional<PackedMedium>> SegmentMediaReader::of_group(MediaGroup& found, uint64_t row) {
  const std::string firsts = found.name + "/first_image";
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * column, source_.column(firsts));
  if (column->rows() < 2) return source_.broken(firsts, "needs two rows or more");
  const uint64_t groups = column->rows() - 1;
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t images, source_.number<uint64_t>(firsts, groups));
  ENGRAM_ASSIGN_OR_RETURN(const auto image, image_of(found, images, row));
  if (!image) return std::optional<PackedMedium>();
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t number, last_not_above(firsts, groups, *image));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t first, source_.number<uint64_t>(firsts, number));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t end, source_.number<uint64_t>(firsts, number + 1));
  // The columns come from a file and may contradict each other; a wrong place would decode another
  // row's image.
  if (*image < first || *image >= end || end > images || end - first > kMaxGroupImages)
    return source_.broken(firsts, fmt::format("image {} has no valid group", *image));
  // Neighbouring rows mostly have images of the same group. The number is cleared first, so that a
  // failed read does not leave old bytes under a new number.
  if (found.last_group != number) {
    found.last_group = UINT64_MAX;
    ENGRAM_ASSIGN_OR_RETURN(found.last_bytes, source_.blob(found.name, number));
    if (found.last_bytes.empty())
      return source_.broken(found.name, fmt::format("group {} has no bytes", number));
    found.last_group = number;
  }
  PackedMedium medium = found.medium;
  medium.bytes = found.last_bytes;
  medium.group = {static_cast<uint32_t>(*image - first), static_cast<uint32_t>(end - first)};
  return std::optional(std::move(medium));
}

/// The number of the image of a row, or nullopt if the row has none.
Result<std::optional<uint64_t>> SegmentMediaReader::image_of(const MediaGroup& found,
                                                             uint64_t images, uint64_t row) {
  const std::string path = found.name + "/row";
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * rows, source_.column_if_there(path));
  if (rows == nullptr) {
    if (row < images) return std::optional(row);
    return source_.broken(found.name,
                          fmt::format("has {} images, needs one of row {}", images, row));
  }
  if (rows->rows() != images || images == 0)
    return source_.broken(path, fmt::format("has {} rows, needs {}", rows->rows(), images));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t image, last_not_above(path, images, row));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t its_row, source_.number<uint64_t>(path, image));
  return its_row == row ? std::optional(image) : std::nullopt;
}

/// Index of the last of the first `count` numbers of an ascending column that is not greater than
/// `value`, or 0 if there is none.
Result<uint64_t> SegmentMediaReader::last_not_above(const std::string& path, uint64_t count,
                                                    uint64_t value) {
  uint64_t min = 0;
  while (count > 1) {
    const uint64_t half = count / 2;
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t middle, source_.number<uint64_t>(path, min + half));
    if (middle <= value) min += half;
    count = middle <= value ? count - half : half;
  }
  return min;
}

Result<std::vector<SegmentMediaReader::MediaGroup>*> SegmentMediaReader::groups_of(
    const std::string& group) {
  if (const auto known = groups_.find(group); known != groups_.end()) return &known->second;
  std::vector<MediaGroup> groups;
  std::vector<std::string> names;
  ENGRAM_ASSIGN_OR_RETURN(const bool has_media, source_.file().exists(group + "/media_groups"));
  if (has_media) {
    ENGRAM_ASSIGN_OR_RETURN(names, source_.file().read_strings(group + "/media_groups"));
  }
  for (const std::string& name : names) {
    ENGRAM_ASSIGN_OR_RETURN(MediaGroup found, open(name));
    groups.push_back(std::move(found));
  }
  return &groups_.emplace(group, std::move(groups)).first->second;
}

Result<SegmentMediaReader::MediaGroup> SegmentMediaReader::open(const std::string& name) {
  const h5::File& file = source_.file();
  MediaGroup found;
  found.name = name;
  ENGRAM_ASSIGN_OR_RETURN(found.medium.path, file.string_attribute(name, "path"));
  ENGRAM_ASSIGN_OR_RETURN(found.medium.codec, file.string_attribute(name, "codec"));
  ENGRAM_ASSIGN_OR_RETURN(const auto type, file.string_attribute(name, "element_type"));
  const auto element = idf::element_type_from_name(type);
  if (!element) return source_.broken(name, "has an unknown element type");
  found.medium.type = *element;
  ENGRAM_ASSIGN_OR_RETURN(found.has_groups, file.exists(name + "/first_image"));
  ENGRAM_ASSIGN_OR_RETURN(const h5::DatasetInfo shape, file.info(name + "/shape"));
  found.has_shapes = shape.shape.size() == 2;
  if (found.has_shapes && found.has_groups)
    return source_.broken(name, "has groups of images, which need one shape");
  if (!found.has_shapes) {
    ENGRAM_ASSIGN_OR_RETURN(const auto sizes, file.read(name + "/shape", h5::Type::kInt64));
    found.medium.shape = h5::as_vector<int64_t>(sizes);
  }
  return found;
}

Result<idf::Shape> SegmentMediaReader::shape(const std::string& path, uint64_t row) {
  ENGRAM_ASSIGN_OR_RETURN(SegmentColumn * shapes, source_.column(path));
  if (shapes->info().type != h5::Type::kInt64) return source_.broken(path, "is no int64");
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, source_.located(shapes->row(row)));
  return h5::as_vector<int64_t>(bytes);
}

}  // namespace engram::ltm
