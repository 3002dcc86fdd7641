// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_format.h"

#include <charconv>
#include <filesystem>

#include "ltm/idf/data.h"

namespace engram::ltm {

namespace {

std::string join_names(const std::vector<std::string>& names) {
  std::string path;
  for (const std::string& name : names) path += "/" + segment_name(name);
  return path;
}

}  // namespace

std::string segment_name(std::string_view name) {
  if (name.empty()) return "%";
  std::string text;
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool is_special = c == '/' || c == '%' || c == '#' || static_cast<unsigned char>(c) < 0x20 ||
                            (c == '.' && i == 0);
    text += is_special ? fmt::format("%{:02X}", static_cast<unsigned char>(c)) : std::string(1, c);
  }
  return text;
}

uint64_t segment_number(const std::string& file) {
  const std::string name = std::filesystem::path(file).filename().string();
  uint64_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc() && std::string_view(end) == ".h5" ? number : 0;
}

std::string segment_group(const MemoryId& entity) { return join_names(entity.names()); }

std::string segment_member(std::string_view path) { return join_names(idf::split_path(path)); }

bool is_scalar(const idf::TensorMember& member) {
  return member.kind == idf::MemberKind::kBool || member.kind == idf::MemberKind::kNumber;
}

std::string scalar_group(const idf::TensorMember& member) {
  return member.kind == idf::MemberKind::kBool ? "bool" : std::string(to_string(member.type));
}

h5::Type h5_type(idf::ElementType type) {
  switch (type) {
    case idf::ElementType::kInt8:
      return h5::Type::kInt8;
    case idf::ElementType::kInt16:
      return h5::Type::kInt16;
    case idf::ElementType::kInt32:
      return h5::Type::kInt32;
    case idf::ElementType::kInt64:
      return h5::Type::kInt64;
    case idf::ElementType::kUInt8:
      return h5::Type::kUInt8;
    case idf::ElementType::kUInt16:
      return h5::Type::kUInt16;
    case idf::ElementType::kUInt32:
      return h5::Type::kUInt32;
    case idf::ElementType::kUInt64:
      return h5::Type::kUInt64;
    case idf::ElementType::kFloat32:
      return h5::Type::kFloat32;
    case idf::ElementType::kFloat64:
      break;
  }
  return h5::Type::kFloat64;
}

}  // namespace engram::ltm
