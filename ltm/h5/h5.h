// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/h5/h5_array.h"

namespace engram::h5 {

/// How a dataset lies in the file.
enum class Storage {
  /// One run of bytes: readable at its offset without HDF5.
  kContiguous,
  /// Chunks of rows, byte-shuffled and deflated, with a checksum each.
  kCompressed,
};

/// What a file is written for.
enum class Audience {
  /// HDF5 1.10 and newer: fewest bytes.
  kOurselves,
  /// Every version that is in use, as h5py writes.
  kEverybody,
};

/// Type and size of a dataset.
struct DatasetInfo {
  Type type = Type::kUInt8;
  std::vector<uint64_t> shape;
  /// Offset in the file of a contiguous dataset; nothing if chunked or empty.
  std::optional<uint64_t> offset;
  /// Rows of a chunk, which are read and checked together; nothing if not chunked.
  std::optional<uint64_t> chunk_rows;

  /// Product of the shape; opened files were checked not to overflow.
  [[nodiscard]] uint64_t count() const;
};

/// One HDF5 file: written once as a whole, or read, or changed in integers that it has. Paths
/// inside are absolute, "/a/b".
///
/// Only this room includes hdf5.h.
/// Errors: every function names the file and the object; a broken file is kDataLoss.
/// Threading: one thread per object; calls of different objects are serialised inside.
class File {
 public:
  /// Errors: kAlreadyExists, kUnavailable.
  static Result<File> create(const std::filesystem::path& path,
                             Audience audience = Audience::kOurselves);

  /// Opens for reading. Errors: kNotFound, kDataLoss where it is no HDF5 file.
  static Result<File> open(const std::filesystem::path& path);

  /// Opens a file of our own to replace values of attributes, and nothing else.
  /// Errors: kNotFound, kDataLoss where it is no HDF5 file or cannot be written.
  static Result<File> change(const std::filesystem::path& path);

  File(File&&) noexcept;
  File& operator=(File&&) noexcept;
  ~File();

  /// Flushes and closes what was written; nothing may follow.
  Status close();

  /// Makes a group and those above it; fine where it exists.
  Status make_group(const std::string& path);

  /// Writes a dataset, groups above it included. `bytes` are row-major elements of `type`.
  Status write(const std::string& path, Type type, std::span<const uint64_t> shape,
               std::span<const std::byte> bytes, Storage storage);

  /// A 1-D compressed dataset of UTF-8 strings, each padded with zeros to the longest: HDF5 keeps
  /// those of variable length without a checksum and crashes where they are damaged.
  /// Errors: kInvalidArgument where a string has a zero byte.
  Status write_strings(const std::string& path, std::span<const std::string> values);

  Status write_attribute(const std::string& object, const std::string& name,
                         std::string_view value);
  Status write_attribute(const std::string& object, const std::string& name, int64_t value);
  Status write_attribute(const std::string& object, const std::string& name, double value);

  /// Of any kind but kOther. Texts are written of variable length, but where they are fixed.
  Status write_attribute(const std::string& object, const std::string& name,
                         const Attribute& value);

  /// Gives an attribute that is one integer another value: the file keeps its size and is, byte for
  /// byte, the one that would have been written with this value.
  /// Errors: kNotFound; kDataLoss where it is no integer.
  Status replace_attribute(const std::string& object, const std::string& name, int64_t value);

  /// Makes a dataset, groups above it included, which its rows are written into. Needs a shape of
  /// an axis or more (checked).
  Status create_array(const std::string& path, const ArrayInfo& info);

  /// Writes rows of numbers from row `first` on; whole chunks at a time are fastest.
  Status write_array_rows(const std::string& path, uint64_t first,
                          std::span<const std::byte> bytes);

  /// Writes texts, or bytes, of an array of one axis from row `first` on.
  Status write_array_texts(const std::string& path, uint64_t first,
                           std::span<const std::string> texts);

  /// Closes an array that create_array made.
  Status finish_array(const std::string& path);

  /// Errors: kDataLoss where a group on the way is damaged.
  Result<bool> exists(const std::string& path) const;

  /// True for groups, false for datasets. Errors: kNotFound, kDataLoss where it is damaged.
  Result<bool> is_group(const std::string& path) const;

  /// Names in a group, in the order of their bytes. Errors: kNotFound.
  Result<std::vector<std::string>> list(const std::string& group) const;

  Result<DatasetInfo> info(const std::string& path) const;

  /// Reads all of a dataset, which must be of `type`. At most `max_bytes` (a hostile header
  /// announces more than there is).
  Result<std::vector<std::byte>> read(const std::string& path, Type type,
                                      uint64_t max_bytes = uint64_t{1} << 34) const;

  /// Reads rows [first, first + count) along axis 0.
  Result<std::vector<std::byte>> read_rows(const std::string& path, Type type, uint64_t first,
                                           uint64_t count) const;

  Result<std::vector<std::string>> read_strings(const std::string& path) const;

  Result<std::string> string_attribute(const std::string& object, const std::string& name) const;
  Result<int64_t> int_attribute(const std::string& object, const std::string& name) const;
  Result<double> double_attribute(const std::string& object, const std::string& name) const;

  /// What a dataset of other people is. Errors: kDataLoss where it announces more than it can hold
  /// or needs a filter that is not there.
  Result<ArrayInfo> array_info(const std::string& path) const;

  /// Numbers of rows [first, first + count) along axis 0, as they are in memory. At most
  /// `max_bytes`.
  Result<std::vector<std::byte>> read_array_rows(const std::string& path, uint64_t first,
                                                 uint64_t count,
                                                 uint64_t max_bytes = uint64_t{1} << 30) const;

  /// Texts, or bytes, of an array of one axis.
  Result<std::vector<std::string>> read_array_texts(const std::string& path, uint64_t first,
                                                    uint64_t count) const;

  /// In the order of their bytes.
  Result<std::vector<std::string>> attribute_names(const std::string& object) const;

  Result<Attribute> attribute(const std::string& object, const std::string& name) const;

  /// Bytes in the file that the datasets below `path` take.
  Result<uint64_t> storage_bytes(const std::string& path) const;

  [[nodiscard]] const std::filesystem::path& path() const;

 private:
  struct State;
  explicit File(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// Elements of a read dataset as numbers of T; bytes beyond the last whole one are left out.
template <typename T>
[[nodiscard]] std::vector<T> as_vector(std::span<const std::byte> bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

}  // namespace engram::h5
