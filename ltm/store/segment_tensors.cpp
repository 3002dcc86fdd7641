// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_tensors.h"

#include <algorithm>
#include <map>

#include "ltm/store/number_blocks.h"
#include "ltm/store/segment_column.h"
#include "ltm/store/segment_format.h"

namespace engram::ltm {

namespace {

/// Max number of layouts that are counted. Rows of further layouts are kept whole.
constexpr size_t kMaxLayoutsCounted = 32;

/// Replaces zero bytes, at which HDF5 strings end. The segment reader takes paths from the layout
/// instead.
std::string printable(std::string path) {
  std::ranges::replace(path, '\0', '?');
  return path;
}

}  // namespace

idf::Layout most_common_layout(const std::vector<SegmentRow>& rows) {
  std::vector<std::pair<idf::Layout, size_t>> counts;
  for (const SegmentRow& row : rows) {
    const idf::Layout layout = idf::Layout::of(row.packed().value.rest);
    const auto known = std::ranges::find(counts, layout, &std::pair<idf::Layout, size_t>::first);
    if (known != counts.end())
      ++known->second;
    else if (counts.size() < kMaxLayoutsCounted)
      counts.emplace_back(layout, 1);
  }
  const auto best = std::ranges::max_element(counts, {}, &std::pair<idf::Layout, size_t>::second);
  return best == counts.end() || best->second * 2 < rows.size() ? idf::Layout() : best->first;
}

TensorColumns::TensorColumns(const idf::Layout& layout, size_t rows, const SealRules& rules)
    : layout_(layout), rows_(rows), rules_(rules) {
  for (const idf::TensorMember& member : layout.members())
    values_.emplace_back(rows * *idf::size_bytes(member.type, member.shape));
}

void TensorColumns::set(size_t row, const std::vector<idf::NdArray>& tensors) {
  for (size_t i = 0; i < tensors.size(); ++i) {
    const auto bytes = tensors[i].bytes();
    std::ranges::copy(bytes, values_[i].begin() + static_cast<ptrdiff_t>(row * bytes.size()));
  }
}

Status TensorColumns::write(h5::File& file, const std::string& group) const {
  std::map<std::string, std::vector<size_t>> scalars;
  for (size_t i = 0; i < values_.size(); ++i) {
    const idf::TensorMember& member = layout_.members()[i];
    if (is_scalar(member))
      scalars[scalar_group(member)].push_back(i);
    else
      ENGRAM_RETURN_IF_ERROR(write_array(file, group, i));
  }
  for (const auto& [name, members] : scalars)
    ENGRAM_RETURN_IF_ERROR(write_scalars(file, group + "/columns/" + name, members));
  return {};
}

Status TensorColumns::write_array(h5::File& file, const std::string& group, size_t index) const {
  const idf::TensorMember& member = layout_.members()[index];
  const std::string name = group + "/arrays" + segment_member(member.path);
  const size_t elements =
      *idf::size_bytes(member.type, member.shape) / idf::size_bytes(member.type);
  if (rows_ > 0 && elements > 0 && rules_.are_columns(member.path))
    return write_number_blocks(file, name, {member.type, rows_, 1, elements}, values_[index]);
  std::vector<uint64_t> shape{rows_};
  for (const int64_t size : member.shape) shape.push_back(static_cast<uint64_t>(size));
  return file.write(name, h5_type(member.type), shape, values_[index], h5::Storage::kCompressed);
}

Status TensorColumns::write_scalars(h5::File& file, const std::string& group,
                                    const std::vector<size_t>& members) const {
  const idf::ElementType type = layout_.members()[members.front()].type;
  const size_t size = idf::size_bytes(type);
  // Scalars of one type share a matrix, because a dataset for each would cost about 1 KB of headers
  // per member and segment.
  std::vector<std::byte> matrix(rows_ * members.size() * size);
  std::vector<std::string> paths;
  bool are_blocks = false;
  for (size_t column = 0; column < members.size(); ++column) {
    const std::string& path = layout_.members()[members[column]].path;
    are_blocks = are_blocks || (rows_ > 0 && rules_.are_columns(path));
    paths.push_back(printable(path));
    for (size_t row = 0; row < rows_; ++row)
      std::copy_n(values_[members[column]].data() + row * size, size,
                  matrix.data() + (row * members.size() + column) * size);
  }
  const std::vector<uint64_t> shape{rows_, members.size()};
  ENGRAM_RETURN_IF_ERROR(file.write_strings(group + "/paths", paths));
  if (are_blocks)
    return write_number_blocks(file, group + "/values", {type, rows_, members.size(), 1}, matrix);
  return file.write(group + "/values", h5_type(type), shape, matrix, h5::Storage::kCompressed);
}

}  // namespace engram::ltm
