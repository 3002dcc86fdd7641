// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/h5.h"

#include <hdf5.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

namespace engram::h5 {

namespace {

/// Rows of a chunk are chosen so that it takes about this much, and has no more than so many: who
/// asks for one row waits for its chunk.
constexpr uint64_t kChunkBytes = 64 << 10;
constexpr uint64_t kChunkRows = 2048;
/// Datasets that stay open for reading; opening one costs more than reading a chunk of it.
constexpr size_t kMaxOpenDatasets = 64;
/// Smaller datasets lie in their header: a chunk would cost more than it saves.
constexpr uint64_t kCompactBytes = 128;
constexpr unsigned kDeflateLevel = 6;
constexpr uint64_t kMaxStringBytes = 1 << 30;

/// HDF5 keeps global state; one lock serialises all our calls, whatever the library's build.
std::mutex& library_mutex() {
  static std::mutex mutex;
  // A file that could not be written to the end (a full disk) stays half-open inside HDF5, whose
  // clean-up at exit then crashes. We close all that we open.
  [[maybe_unused]] static const herr_t is_unregistered = H5dont_atexit();
  return mutex;
}

/// Closes an HDF5 identifier when it goes.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (valid()) close_(id_);
  }
  /// False where closing failed: HDF5 writes much of a dataset only then.
  [[nodiscard]] bool finish() { return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }
  [[nodiscard]] bool valid() const { return id_ >= 0; }
  operator hid_t() const { return id_; }  // NOLINT: an HDF5 handle is used as one

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

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

std::optional<Type> type_of(hid_t h5_type) {
  for (int i = 0; i <= static_cast<int>(Type::kFloat64); ++i)
    if (H5Tequal(h5_type, memory_type(static_cast<Type>(i))) > 0) return static_cast<Type>(i);
  return std::nullopt;
}

/// UTF-8 of at most `size` bytes, padded with zeros.
Handle string_type(size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<size_t>(size, 1));
  H5Tset_cset(type, H5T_CSET_UTF8);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return type;
}

/// Creation properties of an object without a time stamp: the same content, the same bytes.
Handle without_times(hid_t property_class) {
  Handle list(H5Pcreate(property_class), H5Pclose);
  H5Pset_obj_track_times(list, false);
  return list;
}

Handle creation_list(Storage storage, size_t element_bytes, std::span<const uint64_t> shape) {
  Handle list = without_times(H5P_DATASET_CREATE);
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

struct File::State {
  struct OpenDataset {
    Handle handle;
    DatasetInfo info;
  };

  std::filesystem::path path;
  Handle file;
  std::map<std::string, OpenDataset, std::less<>> open_datasets;  ///< For reading rows.

  ~State() {
    const std::scoped_lock lock(library_mutex());
    open_datasets.clear();
    file = Handle();
  }

  Status error(StatusCode code, const std::string& object, std::string_view what) const {
    return Status(code, fmt::format("HDF5 file '{}': '{}': {}", path.string(), object, what));
  }
  Status broken(const std::string& object, std::string_view what) const {
    return error(StatusCode::kDataLoss, object, what);
  }
  Status write_failed(const std::string& object) const {
    return error(StatusCode::kUnavailable, object, "cannot be written");
  }

  /// H5Lexists fails on paths whose parents are missing: look at each level. Where it fails for
  /// another reason, a group is damaged.
  Result<bool> look_up(const std::string& object) const {
    if (object == "/") return true;
    for (size_t slash = object.find('/', 1);; slash = object.find('/', slash + 1)) {
      const std::string level = object.substr(0, slash);
      const htri_t found = H5Lexists(file, level.c_str(), H5P_DEFAULT);
      if (found < 0) return broken(level, "cannot be looked up: its group is damaged");
      if (found == 0) return false;
      if (slash == std::string::npos) return true;
    }
  }

  bool exists(const std::string& object) const { return look_up(object).value_or(false); }

  /// Errors: kNotFound, kDataLoss.
  Status check_exists(const std::string& object) const {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_there, look_up(object));
    return is_there ? Status() : error(StatusCode::kNotFound, object, "does not exist");
  }

  Result<Handle> open_dataset(const std::string& object) const {
    // Callers keep the chunks that they need: HDF5 need not keep them, too.
    const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    H5Pset_chunk_cache(access, 0, 0, 1.0);
    Handle dataset(H5Dopen2(file, object.c_str(), access), H5Dclose);
    if (dataset.valid()) return dataset;
    // Looking for it first would cost more than opening it.
    ENGRAM_RETURN_IF_ERROR(check_exists(object));
    return broken(object, "is no dataset");
  }

  /// The dataset and what is known of it; valid until the next call.
  Result<const OpenDataset*> kept_open(const std::string& object) {
    if (const auto known = open_datasets.find(object); known != open_datasets.end())
      return &known->second;
    ENGRAM_ASSIGN_OR_RETURN(Handle dataset, open_dataset(object));
    ENGRAM_ASSIGN_OR_RETURN(DatasetInfo found, info(object, dataset));
    if (open_datasets.size() >= kMaxOpenDatasets) open_datasets.clear();
    const auto added =
        open_datasets.emplace(object, OpenDataset{std::move(dataset), std::move(found)});
    return &added.first->second;
  }

  Result<Handle> open_attribute(const std::string& object, const std::string& name) const {
    ENGRAM_RETURN_IF_ERROR(check_exists(object));
    Handle attribute(H5Aopen_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose);
    if (!attribute.valid())
      return error(StatusCode::kNotFound, object, fmt::format("has no attribute '{}'", name));
    return attribute;
  }

  Result<DatasetInfo> info(const std::string& object, hid_t dataset) const {
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

  /// Makes a group and those above it where they are missing.
  Status make_groups(const std::string& group_path) {
    if (group_path.empty() || exists(group_path)) return {};
    ENGRAM_RETURN_IF_ERROR(make_groups(group_path.substr(0, group_path.rfind('/'))));
    const Handle creation = without_times(H5P_GROUP_CREATE);
    const Handle group(H5Gcreate2(file, group_path.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT),
                       H5Gclose);
    return group.valid() ? Status() : write_failed(group_path);
  }

  Status write_attribute(const std::string& object, const std::string& name, hid_t type,
                         const void* value) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate_by_name(file, object.c_str(), name.c_str(), type, space,
                                             H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    if (!attribute.valid() || H5Awrite(attribute, type, value) < 0)
      return write_failed(object + "@" + name);
    return {};
  }

  template <typename T>
  Result<T> number_attribute(const std::string& object, const std::string& name, hid_t type,
                             H5T_class_t type_class) const {
    ENGRAM_ASSIGN_OR_RETURN(const Handle attribute, open_attribute(object, name));
    const Handle stored(H5Aget_type(attribute), H5Tclose);
    const Handle space(H5Aget_space(attribute), H5Sclose);
    T value{};
    if (H5Tget_class(stored) != type_class || H5Sget_simple_extent_npoints(space) != 1 ||
        H5Aread(attribute, type, &value) < 0)
      return broken(object, fmt::format("attribute '{}' is not one number", name));
    return value;
  }
};

size_t size_bytes(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUInt8:
      return 1;
    case Type::kInt16:
    case Type::kUInt16:
      return 2;
    case Type::kInt32:
    case Type::kUInt32:
    case Type::kFloat32:
      return 4;
    default:
      return 8;
  }
}

uint64_t DatasetInfo::count() const {
  uint64_t total = 1;
  for (const uint64_t size : shape) total *= size;
  return total;
}

File::File(std::unique_ptr<State> state) : state_(std::move(state)) {}
File::File(File&&) noexcept = default;
File& File::operator=(File&&) noexcept = default;
File::~File() = default;

Result<File> File::create(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored))
    return already_exists("HDF5 file '{}' exists", path.string());
  // Before the lock, so that it goes after it: its destructor takes the lock itself.
  auto state = std::make_unique<State>();
  state->path = path;
  const std::scoped_lock lock(library_mutex());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // The 1.10 format spends far fewer bytes per dataset than the default of 1.8 and older.
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const Handle creation = without_times(H5P_FILE_CREATE);
  state->file = Handle(H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation, access), H5Fclose);
  if (!state->file.valid()) return unavailable("HDF5 file '{}': cannot be created", path.string());
  return File(std::move(state));
}

Result<File> File::open(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path))
    return not_found("HDF5 file '{}' does not exist", path.string());
  // Before the lock, so that it goes after it: its destructor takes the lock itself.
  auto state = std::make_unique<State>();
  state->path = path;
  const std::scoped_lock lock(library_mutex());
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  state->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!state->file.valid()) return data_loss("'{}': is damaged or no HDF5 file", path.string());
  return File(std::move(state));
}

Status File::close() {
  const std::scoped_lock lock(library_mutex());
  state_->open_datasets.clear();
  if (H5Fflush(state_->file, H5F_SCOPE_GLOBAL) < 0) return state_->write_failed("/");
  if (!state_->file.finish()) return state_->write_failed("/");
  return {};
}

Status File::make_group(const std::string& path) {
  const std::scoped_lock lock(library_mutex());
  return state_->make_groups(path);
}

Status File::write(const std::string& path, Type type, std::span<const uint64_t> shape,
                   std::span<const std::byte> bytes, Storage storage) {
  uint64_t needed = size_bytes(type);
  for (const uint64_t size : shape) needed *= size;
  ENGRAM_CHECK(needed == bytes.size(), "'{}' has {} bytes, its shape {}", path, bytes.size(),
               needed);
  const std::scoped_lock lock(library_mutex());
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
  const std::scoped_lock lock(library_mutex());
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
  Handle dataset(H5Dcreate2(state_->file, path.c_str(), type, space, H5P_DEFAULT, creation,
                            H5P_DEFAULT),
                 H5Dclose);
  if (!dataset.valid() ||
      (count > 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0) ||
      !dataset.finish())
    return state_->write_failed(path);
  return {};
}

Status File::write_attribute(const std::string& object, const std::string& name,
                             std::string_view value) {
  const std::scoped_lock lock(library_mutex());
  // Fixed length: variable-length attributes would add a heap of their own to each file.
  const Handle type = string_type(value.size());
  const std::string padded = value.empty() ? std::string(1, '\0') : std::string(value);
  return state_->write_attribute(object, name, type, padded.data());
}

Status File::write_attribute(const std::string& object, const std::string& name, int64_t value) {
  const std::scoped_lock lock(library_mutex());
  return state_->write_attribute(object, name, H5T_NATIVE_INT64, &value);
}

Status File::write_attribute(const std::string& object, const std::string& name, double value) {
  const std::scoped_lock lock(library_mutex());
  return state_->write_attribute(object, name, H5T_NATIVE_DOUBLE, &value);
}

Result<bool> File::exists(const std::string& path) const {
  const std::scoped_lock lock(library_mutex());
  return state_->look_up(path);
}

Result<bool> File::is_group(const std::string& path) const {
  const std::scoped_lock lock(library_mutex());
  H5O_info_t info{};
  if (H5Oget_info_by_name2(state_->file, path.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0) {
    ENGRAM_RETURN_IF_ERROR(state_->check_exists(path));
    return state_->broken(path, "is damaged");
  }
  return info.type == H5O_TYPE_GROUP;
}

Result<std::vector<std::string>> File::list(const std::string& group) const {
  const std::scoped_lock lock(library_mutex());
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
  const std::scoped_lock lock(library_mutex());
  ENGRAM_ASSIGN_OR_RETURN(const State::OpenDataset* opened, state_->kept_open(path));
  return opened->info;
}

Result<std::vector<std::byte>> File::read(const std::string& path, Type type,
                                          uint64_t max_bytes) const {
  const std::scoped_lock lock(library_mutex());
  ENGRAM_ASSIGN_OR_RETURN(const Handle dataset, state_->open_dataset(path));
  ENGRAM_ASSIGN_OR_RETURN(const DatasetInfo info, state_->info(path, dataset));
  if (info.type != type) return state_->broken(path, "has another element type than needed");
  const uint64_t needed = info.count() * size_bytes(type);
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
  const std::scoped_lock lock(library_mutex());
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
  const std::scoped_lock lock(library_mutex());
  ENGRAM_ASSIGN_OR_RETURN(const Handle dataset, state_->open_dataset(path));
  const Handle stored(H5Dget_type(dataset), H5Tclose);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  // Strings of variable length are not read: HDF5 crashes where they are damaged.
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
  const std::scoped_lock lock(library_mutex());
  ENGRAM_ASSIGN_OR_RETURN(const Handle attribute, state_->open_attribute(object, name));
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
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
  const std::scoped_lock lock(library_mutex());
  return state_->number_attribute<int64_t>(object, name, H5T_NATIVE_INT64, H5T_INTEGER);
}

Result<double> File::double_attribute(const std::string& object, const std::string& name) const {
  const std::scoped_lock lock(library_mutex());
  return state_->number_attribute<double>(object, name, H5T_NATIVE_DOUBLE, H5T_FLOAT);
}

Result<uint64_t> File::storage_bytes(const std::string& path) const {
  const std::scoped_lock lock(library_mutex());
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

const std::filesystem::path& File::path() const {
  return state_->path;
}

}  // namespace engram::h5
