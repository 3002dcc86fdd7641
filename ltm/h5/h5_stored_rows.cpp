// SPDX-License-Identifier: Apache-2.0
// Gathers stored rows of arrays without HDF5's code for chunks.
#include <algorithm>

#include "ltm/h5/h5_state.h"

namespace engram::h5 {

namespace {

/// Copies the elements that a chunk and the wanted rows have in common.
class ChunkCopy {
 public:
  ChunkCopy(const OpenArray& array, uint64_t first, uint64_t count, RawBytes& out)
      : array_(array), first_(first), count_(count), out_(out) {}

  void run(const std::vector<hsize_t>& corner, RawView chunk) { copy(corner, chunk, 0, 0, 0); }

 private:
  /// `from` and `to` are counted in elements, at the axes before `axis`.
  void copy(const std::vector<hsize_t>& corner, RawView chunk, size_t axis, uint64_t from,
            uint64_t to) {
    const auto& shape = array_.info.shape;
    const uint64_t begin = axis == 0 ? first_ : 0;
    const uint64_t size = axis == 0 ? count_ : shape[axis];
    const uint64_t low = std::max<uint64_t>(corner[axis], begin);
    const uint64_t high = std::min<uint64_t>(corner[axis] + array_.chunk[axis], begin + size);
    if (low >= high) return;
    from = from * array_.chunk[axis] + low - corner[axis];
    to = to * size + low - begin;
    if (axis + 1 == shape.size()) {
      const uint64_t bytes = array_.element_bytes;
      std::memcpy(out_.data() + to * bytes, chunk.data() + from * bytes, (high - low) * bytes);
      return;
    }
    for (uint64_t i = low; i < high; ++i, ++from, ++to) copy(corner, chunk, axis + 1, from, to);
  }

  const OpenArray& array_;
  uint64_t first_;
  uint64_t count_;
  RawBytes& out_;
};

/// Advances to the next chunk with wanted rows. Returns false if there is none.
bool advance(const OpenArray& array, uint64_t end, std::vector<hsize_t>& corner) {
  for (size_t axis = corner.size(); axis-- > 0;) {
    corner[axis] += array.chunk[axis];
    if (corner[axis] < (axis == 0 ? end : array.info.shape[axis])) return true;
    corner[axis] = 0;
  }
  return false;
}

}  // namespace

Result<RawBytes> File::State::stored_rows(const OpenArray& array, uint64_t first,
                                          uint64_t count) const {
  const uint64_t row_bytes = array.info.row_elements() * array.element_bytes;
  // Rows that were never written are zero.
  RawBytes rows(row_bytes * count);
  if (rows.empty()) return rows;
  if (array.chunk.empty()) {
    const haddr_t offset = H5Dget_offset(array.handle);
    if (offset != HADDR_UNDEF) return raw->read(offset + first * row_bytes, rows.size());
    const Handle stored(H5Dget_type(array.handle), H5Tclose);
    // Compact data is in the header. check_dataset() has verified that it is complete.
    if (H5Dget_storage_size(array.handle) == 0 || !array.info.element.is_number()) return rows;
    RawBytes all(row_bytes * array.info.rows());
    if (H5Dread(array.handle, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0)
      return data_loss("cannot be read");
    std::copy_n(all.begin() + static_cast<ptrdiff_t>(first * row_bytes), rows.size(), rows.begin());
    return rows;
  }
  uint64_t chunk_bytes = array.element_bytes;
  for (const uint64_t size : array.chunk) chunk_bytes *= size;
  ChunkCopy copy(array, first, count, rows);
  std::vector<hsize_t> corner(array.chunk.size(), 0);
  corner[0] = first / array.chunk[0] * array.chunk[0];
  do {
    haddr_t offset = HADDR_UNDEF;
    hsize_t size = 0;
    unsigned skipped = 0;
    if (H5Dget_chunk_info_by_coord(array.handle, corner.data(), &skipped, &offset, &size) < 0)
      return data_loss("the list of chunks is damaged");
    if (offset == HADDR_UNDEF) continue;
    ENGRAM_ASSIGN_OR_RETURN(RawBytes stored, raw->read(offset, size));
    ENGRAM_ASSIGN_OR_RETURN(const RawBytes chunk,
                            unfiltered_chunk(std::move(stored), array.filters, skipped, chunk_bytes,
                                             array.element_bytes));
    copy.run(corner, chunk);
  } while (advance(array, first + count, corner));
  return rows;
}

}  // namespace engram::h5
