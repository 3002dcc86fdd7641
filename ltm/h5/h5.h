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

/// How a dataset is stored in the file.
enum class Storage {
  /// One run of bytes, readable at its offset without HDF5.
  kContiguous,
  /// Chunks of rows, byte-shuffled and deflated, each with a checksum.
  kCompressed,
};

/// The programs that can read a written file.
enum class Audience {
  /// HDF5 1.10 and newer. Takes the fewest bytes.
  kOurselves,
  /// Every HDF5 version in use. The files are like those that h5py writes.
  kEverybody,
};

/// Type and size of a dataset.
struct DatasetInfo {
  Type type = Type::kUInt8;
  std::vector<uint64_t> shape;
  /// Offset in the file of a contiguous dataset; nullopt if chunked or empty.
  std::optional<uint64_t> offset;
  /// Number of rows of a chunk, which are read and checked together; nullopt if not chunked.
  std::optional<uint64_t> chunk_rows;

  /// Product of the shape. It does not overflow: opened files are checked.
  [[nodiscard]] uint64_t count() const;
};

/// One HDF5 file. It is written once as a whole, or read, or some of its integers are replaced.
/// Paths inside are absolute, "/a/b".
///
/// Only this room includes hdf5.h.
/// Errors: every function names the file and the object; a damaged file is kDataLoss.
/// Threading: one thread per object; calls on different objects are serialised inside.
class File {
 public:
  /// Creates a file for writing. Errors: kAlreadyExists, kUnavailable.
  static Result<File> create(const std::filesystem::path& path,
                             Audience audience = Audience::kOurselves);

  /// Opens a file for reading. Errors: kNotFound, kDataLoss if it is not an HDF5 file.
  static Result<File> open(const std::filesystem::path& path);

  /// Opens a file that this library wrote, only to replace values of attributes.
  /// Errors: kNotFound, kDataLoss if it is not an HDF5 file or cannot be written.
  static Result<File> change(const std::filesystem::path& path);

  File(File&&) noexcept;
  File& operator=(File&&) noexcept;
  ~File();

  /// Flushes and closes the file. No other call may follow.
  Status close();

  /// Creates a group and its missing parents. Ok if the group exists.
  Status make_group(const std::string& path);

  /// Writes a dataset and creates its missing parent groups. `bytes` are row-major elements of
  /// `type`.
  Status write(const std::string& path, Type type, std::span<const uint64_t> shape,
               std::span<const std::byte> bytes, Storage storage);

  /// Writes a 1-D compressed dataset of UTF-8 strings, each padded with zeros to the longest. HDF5
  /// stores strings of variable length without a checksum and crashes if they are damaged.
  /// Errors: kInvalidArgument if a string has a zero byte.
  Status write_strings(const std::string& path, std::span<const std::string> values);

  Status write_attribute(const std::string& object, const std::string& name,
                         std::string_view value);
  Status write_attribute(const std::string& object, const std::string& name, int64_t value);
  Status write_attribute(const std::string& object, const std::string& name, double value);

  /// Writes an attribute of any kind except kOther. Texts are written with variable length unless
  /// their kind is fixed.
  Status write_attribute(const std::string& object, const std::string& name,
                         const Attribute& value);

  /// Replaces the value of an attribute that is one integer. The file keeps its size and is, byte
  /// for byte, the one that would have been written with this value.
  /// Errors: kNotFound; kDataLoss if the attribute is not one integer.
  Status replace_attribute(const std::string& object, const std::string& name, int64_t value);

  /// Creates a dataset whose rows are written later, and its missing parent groups. Its shape must
  /// have at least one axis (checked).
  Status create_array(const std::string& path, const ArrayInfo& info);

  /// Writes rows of numbers, beginning at row `first`. Whole chunks at a time are fastest.
  Status write_array_rows(const std::string& path, uint64_t first,
                          std::span<const std::byte> bytes);

  /// Writes texts or bytes of an array of one axis, beginning at row `first`.
  Status write_array_texts(const std::string& path, uint64_t first,
                           std::span<const std::string> texts);

  /// Closes an array that was created by create_array.
  Status finish_array(const std::string& path);

  /// True if the object exists. Errors: kDataLoss if a parent group is damaged.
  Result<bool> exists(const std::string& path) const;

  /// True for groups, false for datasets. Errors: kNotFound, kDataLoss if the object is damaged.
  Result<bool> is_group(const std::string& path) const;

  /// Names in a group, in byte order. Errors: kNotFound.
  Result<std::vector<std::string>> list(const std::string& group) const;

  Result<DatasetInfo> info(const std::string& path) const;

  /// Reads a whole dataset, which must have type `type`. `max_bytes` bounds its size, because a
  /// hostile header may announce any size.
  Result<std::vector<std::byte>> read(const std::string& path, Type type,
                                      uint64_t max_bytes = uint64_t{1} << 34) const;

  /// Reads rows [first, first + count) along axis 0.
  Result<std::vector<std::byte>> read_rows(const std::string& path, Type type, uint64_t first,
                                           uint64_t count) const;

  Result<std::vector<std::string>> read_strings(const std::string& path) const;

  Result<std::string> string_attribute(const std::string& object, const std::string& name) const;
  Result<int64_t> int_attribute(const std::string& object, const std::string& name) const;
  Result<double> double_attribute(const std::string& object, const std::string& name) const;

  /// The element type and shape of a dataset that another program wrote. Errors: kDataLoss if it
  /// announces more than it can contain or needs an unavailable filter.
  Result<ArrayInfo> array_info(const std::string& path) const;

  /// Reads the numbers of rows [first, first + count) along axis 0, in their type in memory.
  /// `max_bytes` bounds their size.
  Result<std::vector<std::byte>> read_array_rows(const std::string& path, uint64_t first,
                                                 uint64_t count,
                                                 uint64_t max_bytes = uint64_t{1} << 30) const;

  /// Reads texts or bytes of an array of one axis.
  Result<std::vector<std::string>> read_array_texts(const std::string& path, uint64_t first,
                                                    uint64_t count) const;

  /// Names of the attributes of an object, in byte order.
  Result<std::vector<std::string>> attribute_names(const std::string& object) const;

  Result<Attribute> attribute(const std::string& object, const std::string& name) const;

  /// Bytes of the file that the datasets below `path` occupy.
  Result<uint64_t> storage_bytes(const std::string& path) const;

  [[nodiscard]] const std::filesystem::path& path() const;

 private:
  struct State;
  explicit File(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// The elements of a read dataset as numbers of T. Bytes after the last whole element are left out.
template <typename T>
[[nodiscard]] std::vector<T> as_vector(std::span<const std::byte> bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

}  // namespace engram::h5
