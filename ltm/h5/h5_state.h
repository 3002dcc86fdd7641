// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: an open file, and the code that reading and writing share.

#include <hdf5.h>

#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "ltm/core/mutex.h"
#include "ltm/h5/chunk_filters.h"
#include "ltm/h5/h5.h"
#include "ltm/h5/object_header.h"
#include "ltm/h5/raw_file.h"

namespace engram::h5 {

/// Serialises all our calls of HDF5, which has global state, regardless of how the library was
/// built. While a thread holds it, HDF5 prints nothing in that thread. It guards only HDF5's own
/// state, not our members.
class LibraryLock {
 public:
  LibraryLock();

 private:
  const MutexLock lock_;
};

/// Owns an HDF5 identifier and closes it when destroyed.
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
  /// Closes the identifier. Returns false on failure, which matters because HDF5 writes much of a
  /// dataset only then.
  [[nodiscard]] bool finish() { return close_(std::exchange(id_, H5I_INVALID_HID)) >= 0; }
  [[nodiscard]] bool valid() const { return id_ >= 0; }
  operator hid_t() const { return id_; }  // NOLINT: an HDF5 handle is used as one

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

hid_t memory_type(Type type);

/// The elements of a type in a file.
Element element_of(hid_t stored);

/// The type in a file of elements of any kind except kOther.
Handle stored_type(const Element& element);

/// The type in memory of numbers.
Handle memory_type(const Element& element);

/// The shape of a data space, or nullopt if it has none or its size in bytes exceeds 63 bits.
std::optional<std::vector<uint64_t>> shape_of(hid_t space, uint64_t element_bytes);

/// Splits bytes into texts of `size` bytes each and removes the zeros at their ends.
std::vector<std::string> unpadded(RawView bytes, size_t size);

/// Creation properties of an object that takes few bytes. It has no time stamp, so that equal
/// content gives equal bytes.
Handle small_object(hid_t property_class);

/// An array that is being read or written.
struct OpenArray {
  Handle handle;
  ArrayInfo info;
  uint64_t element_bytes = 0;   ///< Size of an element in the file.
  std::vector<uint64_t> chunk;  ///< Empty if not chunked.
  std::vector<ChunkFilter> filters;
};

/// Threading: the caller must hold the library's lock, except for the destructor, which takes it.
struct File::State {
  struct OpenDataset {
    Handle handle;
    DatasetInfo info;
  };

  std::filesystem::path path;
  Handle file;
  std::optional<RawFile> raw;  ///< The same file, opened on first use.
  /// Datasets that stay open for reading rows.
  std::map<std::string, OpenDataset, std::less<>> open_datasets;
  std::map<std::string, OpenArray, std::less<>> open_arrays;

  ~State();

  [[nodiscard]] Status error(StatusCode code, const std::string& object,
                             std::string_view what) const;
  [[nodiscard]] Status broken(const std::string& object, std::string_view what) const {
    return error(StatusCode::kDataLoss, object, what);
  }
  [[nodiscard]] Status write_failed(const std::string& object) const {
    return error(StatusCode::kUnavailable, object, "cannot be written");
  }

  /// True if the object exists. Errors: kDataLoss if a parent group is damaged.
  Result<bool> look_up(const std::string& object) const;

  /// Fails if the object does not exist. Errors: kNotFound, kDataLoss.
  Status check_exists(const std::string& object) const;

  Result<Handle> open_dataset(const std::string& object) const;

  /// The open dataset and its description, valid until the next call.
  Result<const OpenDataset*> kept_open(const std::string& object);

  /// The open array and its description, valid until the next call.
  Result<const OpenArray*> kept_array(const std::string& object);

  /// Opens an array. Errors: kDataLoss if its sizes are impossible or a filter is unknown.
  Result<OpenArray> open_array(const std::string& object) const;

  /// Rows in the form that they have in the file.
  Result<RawBytes> stored_rows(const OpenArray& array, uint64_t first, uint64_t count) const;

  /// The messages of an object's header, read without HDF5.
  Result<std::vector<HeaderMessage>> header_of(const std::string& object);

  Result<Handle> open_attribute(const std::string& object, const std::string& name) const;

  Result<DatasetInfo> info(const std::string& object, hid_t dataset) const;

  /// Creates a group and its missing parents.
  Status make_groups(const std::string& group_path);

  Status write_attribute(const std::string& object, const std::string& name, hid_t type,
                         const void* value);
};

}  // namespace engram::h5
