// SPDX-License-Identifier: Apache-2.0
// The reading functions of File.
#include <algorithm>

#include "ltm/h5/h5_state.h"

namespace engram::h5 {

namespace {

constexpr uint64_t kMaxStringBytes = 1 << 30;

/// Reads an attribute into `value`. Returns false if it is not one number of that class.
bool read_number(hid_t attribute, hid_t type, H5T_class_t type_class, void* value) {
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  return H5Tget_class(stored) == type_class && H5Sget_simple_extent_npoints(space) == 1 &&
         H5Aread(attribute, type, value) >= 0;
}

}  // namespace

Result<bool> File::exists(const std::string& path) const {
  const LibraryLock lock;
  return state_->look_up(path);
}

Result<bool> File::is_group(const std::string& path) const {
  const LibraryLock lock;
  H5O_info_t info{};
  // Existence is checked only after a failure, because the check visits each level of the path.
  if (H5Oget_info_by_name2(state_->file, path.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
    ENGRAM_RETURN_IF_ERROR(state_->check_exists(path));
    return state_->broken(path, "is damaged");
  }
  return info.type == H5O_TYPE_GROUP;
}

Result<std::vector<std::string>> File::list(const std::string& group) const {
  const LibraryLock lock;
  ENGRAM_RETURN_IF_ERROR(state_->check_exists(group));
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  if (H5Literate_by_name(state_->file, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect,
                         &names, H5P_DEFAULT) < 0)
    return state_->broken(group, "cannot be listed");
  std::ranges::sort(names);
  return names;
}

Result<DatasetInfo> File::info(const std::string& path) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const State::OpenDataset* opened, state_->kept_open(path));
  return opened->info;
}

Result<std::vector<std::byte>> File::read(const std::string& path, Type type,
                                          uint64_t max_bytes) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const Handle dataset, state_->open_dataset(path));
  ENGRAM_ASSIGN_OR_RETURN(const DatasetInfo info, state_->info(path, dataset));
  if (info.type != type) return state_->broken(path, "has another element type than needed");
  const uint64_t needed = info.count() * size_bytes(type);
  // Checked before allocating: the header may announce any size.
  if (needed > max_bytes)
    return state_->broken(path, fmt::format("has {} bytes, at most {} fit", needed, max_bytes));
  std::vector<std::byte> bytes(needed);
  if (!bytes.empty() &&
      H5Dread(dataset, memory_type(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
    return state_->broken(path, "is damaged: a checksum or chunk does not fit");
  return bytes;
}

Result<std::vector<std::byte>> File::read_rows(const std::string& path, Type type, uint64_t first,
                                               uint64_t count) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const State::OpenDataset* opened, state_->kept_open(path));
  const Handle& dataset = opened->handle;
  const DatasetInfo& info = opened->info;
  if (info.type != type) return state_->broken(path, "has another element type than needed");
  if (info.shape.empty() || first > info.shape[0] || count > info.shape[0] - first)
    return state_->broken(path, fmt::format("has no rows {} to {}", first, first + count));
  const uint64_t rows = info.shape[0];
  std::vector<std::byte> bytes(rows == 0 ? 0 : info.count() / rows * count * size_bytes(type));
  if (bytes.empty()) return bytes;
  std::vector<hsize_t> start(info.shape.size(), 0), size(info.shape.begin(), info.shape.end());
  start[0] = first;
  size[0] = count;
  const Handle file_space(H5Dget_space(dataset), H5Sclose);
  const Handle memory_space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr),
                            H5Sclose);
  if (H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) <
          0 ||
      H5Dread(dataset, memory_type(type), memory_space, file_space, H5P_DEFAULT, bytes.data()) < 0)
    return state_->broken(path, "is damaged: a checksum or chunk does not fit");
  return bytes;
}

Result<std::vector<std::string>> File::read_strings(const std::string& path) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const Handle dataset, state_->open_dataset(path));
  const Handle stored(H5Dget_type(dataset), H5Tclose);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  // Strings of variable length are refused: HDF5 crashes if they are damaged.
  if (H5Tget_class(stored) != H5T_STRING || H5Tis_variable_str(stored) != 0 ||
      H5Sget_simple_extent_ndims(space) != 1 || count < 0)
    return state_->broken(path, "is no list of strings");
  const size_t size = H5Tget_size(stored);
  uint64_t total = 0;
  if (__builtin_mul_overflow(static_cast<uint64_t>(count), size, &total) || total > kMaxStringBytes)
    return state_->broken(path, "has more strings than fit");
  std::string padded(total, '\0');
  if (count > 0 && H5Dread(dataset, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    return state_->broken(path, "is damaged: a checksum or chunk does not fit");
  std::vector<std::string> values;
  for (size_t at = 0; at < total; at += size) {
    const std::string_view text = std::string_view(padded).substr(at, size);
    values.emplace_back(text.substr(0, text.find('\0')));
  }
  return values;
}

Result<std::string> File::string_attribute(const std::string& object,
                                           const std::string& name) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const Handle attribute, state_->open_attribute(object, name));
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  // Fixed length only, for the same reason as in read_strings.
  if (H5Tget_class(stored) != H5T_STRING || H5Tis_variable_str(stored) != 0 ||
      H5Sget_simple_extent_npoints(space) != 1)
    return state_->broken(object, fmt::format("attribute '{}' is no string", name));
  std::string value(H5Tget_size(stored), '\0');
  if (H5Aread(attribute, stored, value.data()) < 0)
    return state_->broken(object, fmt::format("attribute '{}' is damaged", name));
  while (value.ends_with('\0')) value.pop_back();
  return value;
}

Result<int64_t> File::int_attribute(const std::string& object, const std::string& name) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const Handle attribute, state_->open_attribute(object, name));
  int64_t value = 0;
  if (!read_number(attribute, H5T_NATIVE_INT64, H5T_INTEGER, &value))
    return state_->broken(object, fmt::format("attribute '{}' is not one number", name));
  return value;
}

Result<double> File::double_attribute(const std::string& object, const std::string& name) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const Handle attribute, state_->open_attribute(object, name));
  double value = 0;
  if (!read_number(attribute, H5T_NATIVE_DOUBLE, H5T_FLOAT, &value))
    return state_->broken(object, fmt::format("attribute '{}' is not one number", name));
  return value;
}

Result<uint64_t> File::storage_bytes(const std::string& path) const {
  const LibraryLock lock;
  ENGRAM_RETURN_IF_ERROR(state_->check_exists(path));
  uint64_t total = 0;
  const auto add = [](hid_t root, const char* name, const H5O_info_t* info, void* out) -> herr_t {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const Handle dataset(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) return 0;
    *static_cast<uint64_t*>(out) += H5Dget_storage_size(dataset);
    return 0;
  };
  const Handle object(H5Oopen(state_->file, path.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.valid() ||
      H5Ovisit2(object, H5_INDEX_NAME, H5_ITER_NATIVE, add, &total, H5O_INFO_BASIC) < 0)
    return state_->broken(path, "cannot be walked");
  return total;
}

}  // namespace engram::h5
