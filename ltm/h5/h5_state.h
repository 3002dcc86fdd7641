// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: an open file, and what reading and writing share.

#include <hdf5.h>

#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "ltm/h5/h5.h"

namespace engram::h5 {

/// HDF5 keeps global state; one lock serialises all our calls, whatever the library's build. In the
/// thread that has it HDF5 prints nothing.
class LibraryLock {
 public:
  LibraryLock();

 private:
  std::unique_lock<std::mutex> lock_;
};

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

hid_t memory_type(Type type);

/// Creation properties of an object without a time stamp: the same content, the same bytes.
Handle without_times(hid_t property_class);

/// Threading: whoever calls holds the library's lock; the destructor takes it itself.
struct File::State {
  struct OpenDataset {
    Handle handle;
    DatasetInfo info;
  };

  std::filesystem::path path;
  Handle file;
  std::map<std::string, OpenDataset, std::less<>> open_datasets;  ///< For reading rows.

  ~State();

  [[nodiscard]] Status error(StatusCode code, const std::string& object,
                             std::string_view what) const;
  [[nodiscard]] Status broken(const std::string& object, std::string_view what) const {
    return error(StatusCode::kDataLoss, object, what);
  }
  [[nodiscard]] Status write_failed(const std::string& object) const {
    return error(StatusCode::kUnavailable, object, "cannot be written");
  }

  /// Errors: kDataLoss where a group on the way is damaged.
  Result<bool> look_up(const std::string& object) const;

  /// Errors: kNotFound, kDataLoss.
  Status check_exists(const std::string& object) const;

  Result<Handle> open_dataset(const std::string& object) const;

  /// The dataset and what is known of it; valid until the next call.
  Result<const OpenDataset*> kept_open(const std::string& object);

  Result<Handle> open_attribute(const std::string& object, const std::string& name) const;

  Result<DatasetInfo> info(const std::string& object, hid_t dataset) const;

  /// Makes a group and those above it where they are missing.
  Status make_groups(const std::string& group_path);

  Status write_attribute(const std::string& object, const std::string& name, hid_t type,
                         const void* value);
};

}  // namespace engram::h5
