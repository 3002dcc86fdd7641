// SPDX-License-Identifier: Apache-2.0
// Reads arrays in files of other programs.
#include <algorithm>

#include "ltm/h5/h5_state.h"
#include "ltm/h5/variable_values.h"

namespace engram::h5 {

namespace {

constexpr size_t kMaxOpenArrays = 256;
constexpr uint64_t kMaxChunkBytes = uint64_t{1} << 30;
constexpr uint64_t kMaxTextBytes = 1 << 28;
/// Max announced size of an array without stored data. The size of others is bounded by what
/// deflate can shrink.
constexpr uint64_t kMaxUnwrittenBytes = 64 << 20;
constexpr uint64_t kMaxShrinkage = 1100;

uint64_t product(std::span<const uint64_t> shape) {
  uint64_t total = 1;
  for (const uint64_t size : shape) total *= size;
  return total;
}

uint64_t user_block(hid_t file) {
  const Handle creation(H5Fget_create_plist(file), H5Pclose);
  hsize_t size = 0;
  H5Pget_userblock(creation, &size);
  return size;
}

std::optional<ChunkFilter> known_filter(H5Z_filter_t filter) {
  if (filter == H5Z_FILTER_DEFLATE) return ChunkFilter::kDeflate;
  if (filter == H5Z_FILTER_SHUFFLE) return ChunkFilter::kShuffle;
  if (filter == H5Z_FILTER_FLETCHER32) return ChunkFilter::kFletcher32;
  return std::nullopt;
}

/// Reads chunks and filters of an array. Returns what is wrong with them, or an empty string.
std::string read_chunks(hid_t creation, OpenArray& array) {
  // A file must not make us open other files.
  if (H5Pget_external_count(creation) > 0) return "lies in other files, which are not read";
  if (H5Pget_layout(creation) == H5D_VIRTUAL) return "is made of other files, which are not read";
  if (H5Pget_layout(creation) != H5D_CHUNKED) return {};
  std::vector<hsize_t> chunk(array.info.shape.size());
  const int rank = static_cast<int>(chunk.size());
  if (rank == 0 || H5Pget_chunk(creation, rank, chunk.data()) != rank) return "has broken chunks";
  uint64_t bytes = array.element_bytes;
  for (const hsize_t size : chunk)
    if (size == 0 || __builtin_mul_overflow(bytes, size, &bytes) || bytes > kMaxChunkBytes)
      return fmt::format("has chunks of nothing, or of more than {} bytes", kMaxChunkBytes);
  array.chunk.assign(chunk.begin(), chunk.end());
  array.info.chunk_rows = chunk[0];
  for (int i = 0; i < H5Pget_nfilters(creation); ++i) {
    unsigned flags = 0;
    unsigned config = 0;
    unsigned level = 0;
    size_t count = 1;
    const H5Z_filter_t filter = H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &count,
                                               &level, 0, nullptr, &config);
    const auto known = known_filter(filter);
    if (!known)
      return fmt::format("has chunks of filter {}, needs gzip, shuffle or fletcher32", filter);
    array.filters.push_back(*known);
    if (known == ChunkFilter::kDeflate) array.info.deflate_level = static_cast<int>(level);
  }
  return {};
}

/// Converts rows from their type in the file to that in memory.
Status convert(hid_t dataset, const Element& element, uint64_t count, RawBytes& bytes) {
  const Handle stored(H5Dget_type(dataset), H5Tclose);
  const Handle memory = memory_type(element);
  const size_t size = size_bytes(element.type);
  // H5Tconvert converts in place, so the buffer must have room for the larger of the two types.
  bytes.resize(std::max<uint64_t>(bytes.size(), count * size));
  if (H5Tconvert(stored, memory, count, bytes.data(), nullptr, H5P_DEFAULT) < 0)
    return data_loss("numbers cannot be converted");
  bytes.resize(count * size);
  return {};
}

}  // namespace

std::optional<std::vector<uint64_t>> shape_of(hid_t space, uint64_t element_bytes) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || H5Sget_simple_extent_type(space) == H5S_NULL) return std::nullopt;
  std::vector<hsize_t> sizes(static_cast<size_t>(rank));
  H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
  auto total = static_cast<int64_t>(std::max<uint64_t>(element_bytes, kReferenceBytes));
  for (const hsize_t size : sizes)
    if (size > 0 && __builtin_mul_overflow(total, size, &total)) return std::nullopt;
  return std::vector<uint64_t>(sizes.begin(), sizes.end());
}

std::vector<std::string> unpadded(RawView bytes, size_t size) {
  std::vector<std::string> texts;
  for (size_t at = 0; size > 0 && at + size <= bytes.size(); at += size) {
    std::string text(reinterpret_cast<const char*>(bytes.data()) + at, size);
    text.resize(text.find_last_not_of('\0') + 1);
    texts.push_back(std::move(text));
  }
  return texts;
}

Result<std::vector<HeaderMessage>> File::State::header_of(const std::string& object) {
  ENGRAM_RETURN_IF_ERROR(check_exists(object));
  if (!raw) {
    ENGRAM_ASSIGN_OR_RETURN(raw, RawFile::open(path, user_block(file)));
  }
  H5O_info_t info{};
  if (H5Oget_info_by_name2(file, object.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0)
    return broken(object, "is damaged");
  auto header = read_object_header(*raw, info.addr);
  if (!header.ok()) return broken(object, header.status().message());
  return header;
}

Result<OpenArray> File::State::open_array(const std::string& object) const {
  OpenArray array;
  ENGRAM_ASSIGN_OR_RETURN(array.handle, open_dataset(object));
  const Handle type(H5Dget_type(array.handle), H5Tclose);
  const Handle space(H5Dget_space(array.handle), H5Sclose);
  array.info.element = element_of(type);
  array.element_bytes = H5Tget_size(type);
  if (array.info.element.kind == Kind::kText || array.info.element.kind == Kind::kBytes)
    array.element_bytes = kReferenceBytes;
  auto shape = shape_of(space, array.element_bytes);
  if (!shape) return broken(object, "has no shape, or is larger than 63 bits");
  array.info.shape = *std::move(shape);
  const Handle creation(H5Dget_create_plist(array.handle), H5Pclose);
  const std::string wrong = read_chunks(creation, array);
  if (!wrong.empty()) return broken(object, wrong);
  const uint64_t announced = product(array.info.shape) * array.element_bytes;
  const uint64_t stored = H5Dget_storage_size(array.handle);
  if (announced > kMaxUnwrittenBytes && announced / kMaxShrinkage > stored)
    return broken(object, fmt::format("announces {} bytes, only {} are stored", announced, stored));
  return array;
}

Result<const OpenArray*> File::State::kept_array(const std::string& object) {
  if (const auto known = open_arrays.find(object); known != open_arrays.end())
    return &known->second;
  // Check the header first: HDF5 crashes on some damaged datasets as soon as it opens them.
  ENGRAM_ASSIGN_OR_RETURN(const auto header, header_of(object));
  if (const Status status = check_dataset(header); !status.ok())
    return broken(object, status.message());
  ENGRAM_ASSIGN_OR_RETURN(OpenArray opened, open_array(object));
  if (open_arrays.size() >= kMaxOpenArrays) open_arrays.clear();
  return &open_arrays.insert_or_assign(object, std::move(opened)).first->second;
}

Result<ArrayInfo> File::array_info(const std::string& path) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const OpenArray* opened, state_->kept_array(path));
  return opened->info;
}

Result<std::vector<std::byte>> File::read_array_rows(const std::string& path, uint64_t first,
                                                     uint64_t count, uint64_t max_bytes) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const OpenArray* opened, state_->kept_array(path));
  const ArrayInfo& info = opened->info;
  if (!info.element.is_number()) return state_->broken(path, "has no numbers");
  if (first > info.rows() || count > info.rows() - first)
    return state_->broken(path, fmt::format("has no rows {} to {}", first, first + count));
  uint64_t needed = 0;
  if (__builtin_mul_overflow(info.row_bytes(), count, &needed) || needed > max_bytes)
    return state_->broken(
        path, fmt::format("rows of {} bytes, at most {} fit", info.row_bytes(), max_bytes));
  auto bytes = state_->stored_rows(*opened, first, count);
  const Status status =
      bytes.ok() ? convert(opened->handle, info.element, info.row_elements() * count, *bytes)
                 : bytes.status();
  if (!status.ok())
    return state_->broken(path,
                          fmt::format("rows {} to {}: {}", first, first + count, status.message()));
  return bytes;
}

Result<std::vector<std::string>> File::read_array_texts(const std::string& path, uint64_t first,
                                                        uint64_t count) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const OpenArray* opened, state_->kept_array(path));
  const ArrayInfo& info = opened->info;
  if (info.element.is_number() || info.element.kind == Kind::kOther || info.shape.size() != 1)
    return state_->broken(path, "is no list of texts");
  if (first > info.rows() || count > info.rows() - first)
    return state_->broken(path, fmt::format("has no rows {} to {}", first, first + count));
  uint64_t needed = 0;
  if (__builtin_mul_overflow(opened->element_bytes, count, &needed) || needed > kMaxTextBytes)
    return state_->broken(path, fmt::format("{} texts are too many at once", count));
  auto stored = state_->stored_rows(*opened, first, count);
  if (stored.ok() && info.element.kind == Kind::kFixedText)
    return unpadded(*stored, opened->element_bytes);
  auto texts = stored.ok() ? variable_values(*state_->raw, *stored, count)
                           : Result<std::vector<std::string>>(stored.status());
  if (!texts.ok())
    return state_->broken(
        path, fmt::format("rows {} to {}: {}", first, first + count, texts.status().message()));
  return texts;
}

}  // namespace engram::h5
