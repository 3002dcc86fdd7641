// SPDX-License-Identifier: Apache-2.0
#include "cli/idf_files.h"

#include <string>

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"

namespace engram::cli {

namespace {

namespace fs = std::filesystem;

Status unknown_form(const fs::path& path) {
  return invalid_argument("'{}': needs a name that ends in .json or .idf", path.string());
}

}  // namespace

Result<idf::Data> read_value(const fs::path& path) {
  const bool is_json = path.extension() == ".json";
  if (!is_json && path.extension() != ".idf") return unknown_form(path);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(path));
  auto value = is_json ? idf::from_json_text(as_text(bytes.bytes())) : idf::decode(bytes);
  if (!value.ok()) return value.status().with_context(fmt::format("'{}'", path.string()));
  return value;
}

Status write_value(const idf::Data& value, const fs::path& path) {
  if (path.extension() == ".json") {
    ENGRAM_ASSIGN_OR_RETURN(const std::string text, idf::to_json_text(value, 2));
    return replace_file(path, as_bytes(text + "\n"));
  }
  if (path.extension() != ".idf") return unknown_form(path);
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(value));
  return replace_file(path, bytes);
}

Result<idf::Type> find_type(const idf::TypeFile& file, std::string_view name) {
  if (const idf::Type* type = file.find(name)) return *type;
  std::string known;
  for (const idf::Type& type : file.types)
    known += (known.empty() ? "" : ", ") + std::string(type.name());
  return not_found("'{}' has no type '{}', needs one of {}", file.name, name, known);
}

}  // namespace engram::cli
