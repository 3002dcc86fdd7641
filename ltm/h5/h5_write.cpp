// SPDX-License-Identifier: Apache-2.0
// The writing functions of File.
#include <algorithm>

#include "ltm/h5/h5_state.h"

namespace engram::h5 {

namespace {

/// Desired size and max number of rows of a chunk. Reading one row reads its whole chunk.
constexpr uint64_t kChunkBytes = 64 << 10;
constexpr uint64_t kChunkRows = 2048;
/// Datasets up to this size are stored in their header, because a chunk would cost more than it
/// saves.
constexpr uint64_t kCompactBytes = 128;
constexpr unsigned kDeflateLevel = 6;

/// A UTF-8 string type of `size` bytes, padded with zeros.
Handle string_type(size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<size_t>(size, 1));
  H5Tset_cset(type, H5T_CSET_UTF8);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return type;
}

Handle creation_list(Storage storage, size_t element_bytes, std::span<const uint64_t> shape) {
  Handle list = small_object(H5P_DATASET_CREATE);
  // HDF5 would leave some 200 bytes in each dataset for attributes, of which ours have none.
  H5Pset_dset_no_attrs_hint(list, true);
  uint64_t total = element_bytes;
  for (const uint64_t size : shape) total *= size;
  if (storage == Storage::kCompressed && total > 0 && total <= kCompactBytes) {
    H5Pset_layout(list, H5D_COMPACT);
    return list;
  }
  if (storage == Storage::kContiguous || shape.empty() || total == 0) {
    H5Pset_layout(list, H5D_CONTIGUOUS);
    if (total > 0) H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY);
    return list;
  }
  uint64_t row_bytes = element_bytes;
  for (size_t i = 1; i < shape.size(); ++i) row_bytes *= shape[i];
  std::vector<hsize_t> chunk(shape.begin(), shape.end());
  chunk[0] = std::clamp<uint64_t>(kChunkBytes / row_bytes, 1, std::min(shape[0], kChunkRows));
  H5Pset_chunk(list, static_cast<int>(chunk.size()), chunk.data());
  H5Pset_shuffle(list);
  H5Pset_deflate(list, kDeflateLevel);
  H5Pset_fletcher32(list);
  return list;
}

}  // namespace

Status File::make_group(const std::string& path) {
  const LibraryLock lock;
  return state_->make_groups(path);
}

Status File::write(const std::string& path, Type type, std::span<const uint64_t> shape,
                   std::span<const std::byte> bytes, Storage storage) {
  uint64_t needed = size_bytes(type);
  for (const uint64_t size : shape) needed *= size;
  ENGRAM_CHECK(needed == bytes.size(), "'{}' has {} bytes, its shape {}", path, bytes.size(),
               needed);
  const LibraryLock lock;
  const std::vector<hsize_t> sizes(shape.begin(), shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                     H5Sclose);
  ENGRAM_RETURN_IF_ERROR(state_->make_groups(path.substr(0, path.rfind('/'))));
  const Handle creation = creation_list(storage, size_bytes(type), shape);
  Handle dataset(H5Dcreate2(state_->file, path.c_str(), memory_type(type), space, H5P_DEFAULT,
                            creation, H5P_DEFAULT),
                 H5Dclose);
  if (!dataset.valid()) return state_->write_failed(path);
  if (!bytes.empty() &&
      H5Dwrite(dataset, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
    return state_->write_failed(path);
  if (!dataset.finish()) return state_->write_failed(path);
  return {};
}

Status File::write_strings(const std::string& path, std::span<const std::string> values) {
  const LibraryLock lock;
  size_t longest = 1;
  for (const std::string& value : values) {
    if (value.find('\0') != std::string::npos)
      return state_->error(StatusCode::kInvalidArgument, path, "a string has a zero byte");
    longest = std::max(longest, value.size());
  }
  std::string padded(values.size() * longest, '\0');
  for (size_t i = 0; i < values.size(); ++i) values[i].copy(padded.data() + i * longest, longest);
  const hsize_t count = values.size();
  const uint64_t shape = count;
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle type = string_type(longest);
  ENGRAM_RETURN_IF_ERROR(state_->make_groups(path.substr(0, path.rfind('/'))));
  const Handle creation = creation_list(Storage::kCompressed, longest, {&shape, 1});
  Handle dataset(
      H5Dcreate2(state_->file, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
      H5Dclose);
  if (!dataset.valid() ||
      (count > 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0) ||
      !dataset.finish())
    return state_->write_failed(path);
  return {};
}

Status File::write_attribute(const std::string& object, const std::string& name,
                             std::string_view value) {
  const LibraryLock lock;
  // Fixed length, because variable-length attributes would add a heap to each file.
  const Handle type = string_type(value.size());
  const std::string padded = value.empty() ? std::string(1, '\0') : std::string(value);
  return state_->write_attribute(object, name, type, padded.data());
}

Status File::write_attribute(const std::string& object, const std::string& name, int64_t value) {
  const LibraryLock lock;
  return state_->write_attribute(object, name, H5T_NATIVE_INT64, &value);
}

// Opens the attribute through its object, because HDF5 does not find an attribute again for writing
// if it was opened by name.
Status File::replace_attribute(const std::string& object, const std::string& name, int64_t value) {
  const LibraryLock lock;
  ENGRAM_RETURN_IF_ERROR(state_->open_attribute(object, name).status());
  const Handle owner(H5Oopen(state_->file, object.c_str(), H5P_DEFAULT), H5Oclose);
  const Handle attribute(H5Aopen(owner, name.c_str(), H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (H5Tget_class(type) != H5T_INTEGER || H5Sget_simple_extent_npoints(space) != 1)
    return state_->broken(object, fmt::format("attribute '{}' is not one integer", name));
  if (H5Awrite(attribute, H5T_NATIVE_INT64, &value) < 0) return state_->write_failed(object);
  return {};
}

Status File::write_attribute(const std::string& object, const std::string& name, double value) {
  const LibraryLock lock;
  return state_->write_attribute(object, name, H5T_NATIVE_DOUBLE, &value);
}

}  // namespace engram::h5
