// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/h5_state.h"

#include <algorithm>

namespace engram::h5 {

namespace {

/// Max number of datasets that stay open for reading. Opening one costs more than reading one of
/// its chunks.
constexpr size_t kMaxOpenDatasets = 64;

std::optional<Type> type_of(hid_t h5_type) {
  for (int i = 0; i <= static_cast<int>(Type::kFloat64); ++i)
    if (H5Tequal(h5_type, memory_type(static_cast<Type>(i))) > 0) return static_cast<Type>(i);
  return std::nullopt;
}

Mutex& library_mutex() {
  static Mutex mutex;  ///< Guards the global state of HDF5 in this process.
  return mutex;
}

}  // namespace

LibraryLock::LibraryLock() : lock_(library_mutex()) {
  // HDF5 keeps a file half-open if it could not be written completely (a full disk), and its
  // clean-up at exit then crashes. We close everything that we open, so the clean-up is not needed.
  [[maybe_unused]] static const herr_t is_unregistered = H5dont_atexit();
  // External links are disabled, because a file must not make us open other files.
  [[maybe_unused]] static const herr_t has_no_outer_links = H5Lunregister(H5L_TYPE_EXTERNAL);
  // HDF5 keeps this setting per thread. Errors are returned as Status, not printed.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

hid_t memory_type(Type type) {
  switch (type) {
    case Type::kInt8:
      return H5T_NATIVE_INT8;
    case Type::kInt16:
      return H5T_NATIVE_INT16;
    case Type::kInt32:
      return H5T_NATIVE_INT32;
    case Type::kInt64:
      return H5T_NATIVE_INT64;
    case Type::kUInt8:
      return H5T_NATIVE_UINT8;
    case Type::kUInt16:
      return H5T_NATIVE_UINT16;
    case Type::kUInt32:
      return H5T_NATIVE_UINT32;
    case Type::kUInt64:
      return H5T_NATIVE_UINT64;
    case Type::kFloat32:
      return H5T_NATIVE_FLOAT;
    case Type::kFloat64:
      break;
  }
  return H5T_NATIVE_DOUBLE;
}

Handle small_object(hid_t property_class) {
  // From more attributes on HDF5 would keep them in a heap and a tree, of some kilobytes.
  constexpr unsigned kMaxCompactAttributes = 64;
  Handle list(H5Pcreate(property_class), H5Pclose);
  H5Pset_obj_track_times(list, false);
  H5Pset_attr_phase_change(list, kMaxCompactAttributes, 0);
  return list;
}

File::State::~State() {
  const LibraryLock lock;
  open_datasets.clear();
  open_arrays.clear();
  file = Handle();
}

Status File::State::error(StatusCode code, const std::string& object, std::string_view what) const {
  return Status(code, fmt::format("HDF5 file '{}': '{}': {}", path.string(), object, what));
}

Result<bool> File::State::look_up(const std::string& object) const {
  if (object == "/") return true;
  // H5Lexists fails on paths with missing parents, so each level is checked. If it fails for
  // another reason, a group is damaged.
  for (size_t slash = object.find('/', 1);; slash = object.find('/', slash + 1)) {
    const std::string level = object.substr(0, slash);
    const htri_t found = H5Lexists(file, level.c_str(), H5P_DEFAULT);
    if (found < 0) return broken(level, "cannot be looked up: its group is damaged");
    if (found == 0) return false;
    if (slash == std::string::npos) return true;
  }
}

Status File::State::check_exists(const std::string& object) const {
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there, look_up(object));
  return is_there ? Status() : error(StatusCode::kNotFound, object, "does not exist");
}

Result<Handle> File::State::open_dataset(const std::string& object) const {
  // Disable HDF5's chunk cache, because callers keep the chunks that they need.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access, 0, 0, 1.0);
  Handle dataset(H5Dopen2(file, object.c_str(), access), H5Dclose);
  if (dataset.valid()) return dataset;
  // Check existence only after a failure, because the check costs more than opening.
  ENGRAM_RETURN_IF_ERROR(check_exists(object));
  return broken(object, "is no dataset");
}

Result<const File::State::OpenDataset*> File::State::kept_open(const std::string& object) {
  if (const auto known = open_datasets.find(object); known != open_datasets.end())
    return &known->second;
  ENGRAM_ASSIGN_OR_RETURN(Handle dataset, open_dataset(object));
  ENGRAM_ASSIGN_OR_RETURN(DatasetInfo found, info(object, dataset));
  if (open_datasets.size() >= kMaxOpenDatasets) open_datasets.clear();
  const auto added =
      open_datasets.emplace(object, OpenDataset{std::move(dataset), std::move(found)});
  return &added.first->second;
}

Result<Handle> File::State::open_attribute(const std::string& object,
                                           const std::string& name) const {
  ENGRAM_RETURN_IF_ERROR(check_exists(object));
  Handle attribute(H5Aopen_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                   H5Aclose);
  if (!attribute.valid())
    return error(StatusCode::kNotFound, object, fmt::format("has no attribute '{}'", name));
  return attribute;
}

Result<DatasetInfo> File::State::info(const std::string& object, hid_t dataset) const {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  DatasetInfo info;
  const auto element = type_of(type);
  if (!element) return broken(object, "has an element type that is no plain number");
  info.type = *element;
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) return broken(object, "has no shape");
  info.shape.resize(static_cast<size_t>(rank));
  std::vector<hsize_t> sizes(info.shape.size());
  H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  std::ranges::copy(sizes, info.shape.begin());
  const bool is_empty = std::ranges::find(info.shape, 0u) != info.shape.end();
  uint64_t total = is_empty ? 0 : size_bytes(*element);
  for (const uint64_t size : info.shape)
    if (__builtin_mul_overflow(total, size, &total))
      return broken(object, "is larger than 64 bits");
  const haddr_t offset = H5Dget_offset(dataset);
  if (offset != HADDR_UNDEF) info.offset = offset;
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose);
  if (rank > 0 && H5Pget_layout(creation) == H5D_CHUNKED) {
    std::vector<hsize_t> chunk(info.shape.size());
    if (H5Pget_chunk(creation, rank, chunk.data()) != rank)
      return broken(object, "has broken chunks");
    info.chunk_rows = chunk[0];
  }
  return info;
}

Status File::State::make_groups(const std::string& group_path) {
  if (group_path.empty() || look_up(group_path).value_or(false)) return {};
  ENGRAM_RETURN_IF_ERROR(make_groups(group_path.substr(0, group_path.rfind('/'))));
  const Handle creation = small_object(H5P_GROUP_CREATE);
  const Handle group(H5Gcreate2(file, group_path.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT),
                     H5Gclose);
  return group.valid() ? Status() : write_failed(group_path);
}

Status File::State::write_attribute(const std::string& object, const std::string& name, hid_t type,
                                    const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate_by_name(file, object.c_str(), name.c_str(), type, space,
                                           H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  if (!attribute.valid() || H5Awrite(attribute, type, value) < 0)
    return write_failed(object + "@" + name);
  return {};
}

}  // namespace engram::h5
