// SPDX-License-Identifier: Apache-2.0
// Reads attributes in files of other programs.
#include <algorithm>

#include "ltm/h5/h5_state.h"
#include "ltm/h5/variable_values.h"

namespace engram::h5 {

namespace {

constexpr uint64_t kMaxAttributeBytes = 1 << 28;

/// Names of all attributes if some are stored outside the object's header.
Result<std::vector<std::string>> all_names(hid_t file, const std::string& object) {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  if (H5Aiterate_by_name(file, object.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names,
                         H5P_DEFAULT) < 0)
    return data_loss("attributes cannot be listed");
  return names;
}

}  // namespace

Result<std::vector<std::string>> File::attribute_names(const std::string& object) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const auto header, state_->header_of(object));
  std::vector<std::string> names;
  for (const HeaderMessage& message : header)
    if (const auto attribute = header_attribute(message)) names.emplace_back(attribute->name);
  if (has_outer_attributes(header)) {
    auto all = all_names(state_->file, object);
    if (!all.ok()) return state_->broken(object, all.status().message());
    names = *std::move(all);
  }
  std::ranges::sort(names);
  return names;
}

Result<Attribute> File::attribute(const std::string& object, const std::string& name) const {
  const LibraryLock lock;
  ENGRAM_ASSIGN_OR_RETURN(const auto header, state_->header_of(object));
  if (has_broken_attributes(header)) return state_->broken(object, "has damaged attributes");
  ENGRAM_ASSIGN_OR_RETURN(const Handle attribute, state_->open_attribute(object, name));
  const Handle stored(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  const auto failed = [&](std::string_view what) {
    return state_->broken(object, fmt::format("attribute '{}' {}", name, what));
  };
  Attribute value;
  value.element = element_of(stored);
  if (value.element.kind == Kind::kOther) return failed("is of a kind that is not read");
  auto shape = shape_of(space, H5Tget_size(stored));
  if (!shape) return failed("has no value");
  value.shape = *std::move(shape);
  uint64_t count = 1;
  for (const uint64_t size : value.shape) count *= size;
  if (count > kMaxAttributeBytes / std::max<uint64_t>(H5Tget_size(stored), kReferenceBytes))
    return failed(fmt::format("announces {} values", count));
  if (count == 0) return value;
  if (value.element.is_number()) {
    value.bytes.resize(count * size_bytes(value.element.type));
    if (H5Aread(attribute, memory_type(value.element), value.bytes.data()) < 0)
      return failed("is damaged");
    return value;
  }
  if (value.element.kind == Kind::kFixedText) {
    RawBytes bytes(count * H5Tget_size(stored));
    if (H5Aread(attribute, stored, bytes.data()) < 0) return failed("is damaged");
    value.texts = unpadded(bytes, value.element.text_bytes);
    return value;
  }
  for (const HeaderMessage& message : header) {
    const auto found = header_attribute(message);
    if (!found || found->name != name) continue;
    auto texts = variable_values(*state_->raw, found->value, count);
    if (!texts.ok()) return failed(texts.status().message());
    value.texts = *std::move(texts);
    return value;
  }
  return failed("lies outside of the object's header, which is not read");
}

}  // namespace engram::h5
