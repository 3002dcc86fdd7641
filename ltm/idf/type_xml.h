// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// Largest XML file that is read, and most files that one may include in all.
inline constexpr size_t kMaxXmlBytes = size_t{16} << 20;
inline constexpr size_t kMaxXmlFiles = 1000;

/// A file that a type description includes.
struct TypeInclude {
  std::string name;            ///< As written, without brackets: "kitchen/Cup.xml".
  std::filesystem::path path;  ///< Where it was found.
  /// Of the types that the file defines, then of those that it includes itself.
  std::vector<std::string> type_names = {};

  friend bool operator==(const TypeInclude&, const TypeInclude&) = default;
};

/// What one XML type description says.
struct TypeFile {
  std::string name;  ///< The path, or what the caller called the text.
  /// Objects and enums that the file defines, in its order.
  std::vector<Type> types;
  std::vector<TypeInclude> includes;
  /// Those that the included files define, and those that they include; each once.
  std::vector<Type> included_types;
  /// What was read over, as "types.xml:3: ...": code includes, attributes for C++ alone.
  std::vector<std::string> notes;

  /// The type of this name, of this file or an included one; null where there is none.
  [[nodiscard]] const Type* find(std::string_view type_name) const;
};

/// Reads an `<AronTypeDefinition>`: the elements are in docs/idf.md, section "Types in XML".
///
/// Comments right before an object, member or enum value are its documentation, as is a `doc`
/// attribute. A type may be used before it is defined, but may not contain itself. Includes are
/// looked for beside the file, then in `include_paths`; files that include each other are refused.
/// Safe on hostile text: size, depth and numbers are limited, entities are never fetched.
/// Errors: kNotFound, kUnavailable; else kInvalidArgument; every message names the file, the line
/// and what was needed there.
Result<TypeFile> read_type_file(const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& include_paths = {});

/// The same for a text that `name` stands for in messages; includes come from `include_paths`.
Result<TypeFile> parse_type_xml(std::string_view text, std::string_view name,
                                const std::vector<std::filesystem::path>& include_paths = {});

}  // namespace engram::idf
