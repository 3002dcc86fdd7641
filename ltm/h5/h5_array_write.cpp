// SPDX-License-Identifier: Apache-2.0
// Writes arrays and attributes for other programs.
#include <algorithm>

#include "ltm/h5/h5_state.h"

namespace engram::h5 {

namespace {

/// Texts in the form that HDF5 needs: padded to one length, or as pointers.
struct StoredTexts {
  std::string padded;
  std::vector<const char*> pointers;
  std::vector<hvl_t> bytes;

  StoredTexts(const Element& element, std::span<const std::string> texts) {
    const size_t length = std::max<uint64_t>(element.text_bytes, 1);
    if (element.kind == Kind::kFixedText) padded.assign(texts.size() * length, '\0');
    for (size_t i = 0; i < texts.size(); ++i) {
      if (element.kind == Kind::kFixedText)
        texts[i].copy(padded.data() + i * length, length);
      else if (element.kind == Kind::kText)
        pointers.push_back(texts[i].c_str());
      else
        bytes.push_back({texts[i].size(), const_cast<char*>(texts[i].data())});
    }
  }

  [[nodiscard]] const void* data() const {
    if (!padded.empty()) return padded.data();
    if (!pointers.empty()) return pointers.data();
    return bytes.data();
  }
};

Handle creation_list(const ArrayInfo& info) {
  Handle list = small_object(H5P_DATASET_CREATE);
  const bool is_empty = std::ranges::find(info.shape, 0u) != info.shape.end();
  // HDF5 refuses chunks without elements, and filters need chunks.
  if (is_empty || (info.chunk_rows == 0 && info.deflate_level == 0)) return list;
  std::vector<hsize_t> chunk(info.shape.begin(), info.shape.end());
  chunk[0] = std::clamp<uint64_t>(info.chunk_rows, 1, info.shape[0]);
  H5Pset_chunk(list, static_cast<int>(chunk.size()), chunk.data());
  if (info.deflate_level > 0) H5Pset_deflate(list, static_cast<unsigned>(info.deflate_level));
  return list;
}

Status write_rows(const File& file, const std::string& path, hid_t dataset, hid_t type,
                  std::span<const uint64_t> shape, uint64_t first, uint64_t count,
                  const void* data) {
  std::vector<hsize_t> start(shape.size(), 0), size(shape.begin(), shape.end());
  start[0] = first;
  size[0] = count;
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr),
                      H5Sclose);
  if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr) < 0 ||
      H5Dwrite(dataset, type, memory, space, H5P_DEFAULT, data) < 0)
    return unavailable("HDF5 file '{}': '{}': rows {} to {} cannot be written",
                       file.path().string(), path, first, first + count);
  return {};
}

}  // namespace

Status File::write_attribute(const std::string& object, const std::string& name,
                             const Attribute& value) {
  ENGRAM_CHECK(value.element.kind != Kind::kOther, "attribute '{}' is of no kind", name);
  const LibraryLock lock;
  const std::vector<hsize_t> sizes(value.shape.begin(), value.shape.end());
  const Handle space(sizes.empty()
                         ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                     H5Sclose);
  const Handle type = stored_type(value.element);
  const StoredTexts texts(value.element, value.texts);
  const Handle attribute(H5Acreate_by_name(state_->file, object.c_str(), name.c_str(), type, space,
                                           H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  if (!attribute.valid()) return state_->write_failed(object + "@" + name);
  if (value.bytes.empty() && value.texts.empty()) return {};
  const bool is_number = value.element.is_number();
  const Handle in_memory = is_number ? memory_type(value.element) : stored_type(value.element);
  if (H5Awrite(attribute, in_memory, is_number ? value.bytes.data() : texts.data()) < 0)
    return state_->write_failed(object + "@" + name);
  return {};
}

Status File::create_array(const std::string& path, const ArrayInfo& info) {
  ENGRAM_CHECK(!info.shape.empty(), "'{}' has no axis", path);
  const LibraryLock lock;
  const std::vector<hsize_t> sizes(info.shape.begin(), info.shape.end());
  const Handle space(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr),
                     H5Sclose);
  ENGRAM_RETURN_IF_ERROR(state_->make_groups(path.substr(0, path.rfind('/'))));
  const Handle creation = creation_list(info);
  const Handle type = stored_type(info.element);
  Handle dataset(
      H5Dcreate2(state_->file, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
      H5Dclose);
  if (!dataset.valid()) return state_->write_failed(path);
  // The dataset stays open until finish_array, so that writing rows does not open it each time.
  state_->open_arrays.insert_or_assign(path, OpenArray{std::move(dataset), info, 0, {}, {}});
  return {};
}

Status File::write_array_rows(const std::string& path, uint64_t first,
                              std::span<const std::byte> bytes) {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const OpenArray* opened, state_->kept_array(path));
  const uint64_t row_bytes = opened->info.row_bytes();
  if (row_bytes == 0 || bytes.empty()) return {};
  const uint64_t count = bytes.size() / row_bytes;
  ENGRAM_CHECK(count * row_bytes == bytes.size(), "'{}': {} bytes are no rows of {}", path,
               bytes.size(), row_bytes);
  return write_rows(*this, path, opened->handle, memory_type(opened->info.element),
                    opened->info.shape, first, count, bytes.data());
}

Status File::write_array_texts(const std::string& path, uint64_t first,
                               std::span<const std::string> texts) {
  if (texts.empty()) return {};
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const OpenArray* opened, state_->kept_array(path));
  const StoredTexts stored(opened->info.element, texts);
  return write_rows(*this, path, opened->handle, stored_type(opened->info.element),
                    opened->info.shape, first, texts.size(), stored.data());
}

Status File::finish_array(const std::string& path) {
  const LibraryLock lock;
  const auto opened = state_->open_arrays.find(path);
  if (opened == state_->open_arrays.end()) return {};
  // HDF5 writes much of a dataset only when it is closed, so a full disk may only show here.
  const bool is_written = opened->second.handle.finish();
  state_->open_arrays.erase(opened);
  return is_written ? Status() : state_->write_failed(path);
}

}  // namespace engram::h5
