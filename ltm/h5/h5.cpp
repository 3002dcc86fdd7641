// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/h5.h"

#include "ltm/h5/h5_state.h"

namespace engram::h5 {

namespace {

/// HDF5 would wait for ever for the other end of a named pipe.
Status check_is_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto found = std::filesystem::status(path, error);
  if (found.type() == std::filesystem::file_type::not_found)
    return not_found("HDF5 file '{}' does not exist", path.string());
  if (!std::filesystem::is_regular_file(found))
    return data_loss("'{}': found no regular file, needs an HDF5 file", path.string());
  return {};
}

}  // namespace

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

uint64_t ArrayInfo::row_elements() const {
  uint64_t total = 1;
  for (size_t i = 1; i < shape.size(); ++i) total *= shape[i];
  return total;
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

Result<File> File::create(const std::filesystem::path& path, Audience audience) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored))
    return already_exists("HDF5 file '{}' exists", path.string());
  // Created before the lock, so that it is destroyed after it: its destructor takes the lock
  // itself.
  auto state = std::make_unique<State>();
  state->path = path;
  const LibraryLock lock;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // The 1.10 format takes far fewer bytes per dataset than the default, that of 1.8 and older.
  if (audience == Audience::kOurselves)
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const Handle creation = small_object(H5P_FILE_CREATE);
  state->file = Handle(H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation, access), H5Fclose);
  if (!state->file.valid()) return unavailable("HDF5 file '{}': cannot be created", path.string());
  return File(std::move(state));
}

Result<File> File::open(const std::filesystem::path& path) {
  ENGRAM_RETURN_IF_ERROR(check_is_file(path));
  // Created before the lock, so that it is destroyed after it: its destructor takes the lock
  // itself.
  auto state = std::make_unique<State>();
  state->path = path;
  const LibraryLock lock;
  state->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!state->file.valid()) return data_loss("'{}': is damaged or no HDF5 file", path.string());
  return File(std::move(state));
}

Result<File> File::change(const std::filesystem::path& path) {
  ENGRAM_RETURN_IF_ERROR(check_is_file(path));
  auto state = std::make_unique<State>();
  state->path = path;
  const LibraryLock lock;
  state->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  if (!state->file.valid())
    return data_loss("'{}': is damaged, no HDF5 file, or cannot be written", path.string());
  return File(std::move(state));
}

Status File::close() {
  const LibraryLock lock;
  state_->open_datasets.clear();
  state_->open_arrays.clear();
  if (H5Fflush(state_->file, H5F_SCOPE_GLOBAL) < 0) return state_->write_failed("/");
  if (!state_->file.finish()) return state_->write_failed("/");
  return {};
}

const std::filesystem::path& File::path() const {
  return state_->path;
}

}  // namespace engram::h5
