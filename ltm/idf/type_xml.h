// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/type.h"

namespace engram::idf {

/// The bounds of the size of an XML file, and of the number of files that it may include in total.
inline constexpr size_t kMaxXmlBytes = size_t{16} << 20;
inline constexpr size_t kMaxXmlFiles = 1000;

/// A file that a type description includes.
struct TypeInclude {
  std::string name;            ///< As written, without brackets: "kitchen/Cup.xml".
  std::filesystem::path path;  ///< The file that was found.
  /// The names of the types that the file defines, followed by those that it includes.
  std::vector<std::string> type_names = {};

  friend bool operator==(const TypeInclude&, const TypeInclude&) = default;
};

/// The content of one XML type description.
struct TypeFile {
  std::string name;  ///< The path, or the name that the caller gave the text.
  /// The objects and enums that the file defines, in its order.
  std::vector<Type> types;
  std::vector<TypeInclude> includes;
  /// The types that the included files define and include, each once.
  std::vector<Type> included_types;
  /// What was ignored, as "types.xml:3: ...": code includes, attributes for C++ alone.
  std::vector<std::string> notes;

  /// The type of this name, from this file or an included one; null where there is none.
  [[nodiscard]] const Type* find(std::string_view type_name) const;
};

/// Reads an `<AronTypeDefinition>`; docs/idf.md, section "Types in XML", has its elements.
///
/// Comments directly before an object, member or enum value are its documentation, as is a `doc`
/// attribute. A type may be used before it is defined, but may not contain itself. Includes are
/// searched beside the file, then in `include_paths`; files that include each other are refused.
/// Safe on hostile text: size, depth and numbers are bounded, and entities are never fetched.
/// Errors: kNotFound, kUnavailable; otherwise kInvalidArgument. Every message names the file, the
/// line and what was needed there.
Result<TypeFile> read_type_file(const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& include_paths = {});

/// Reads a text instead of a file; `name` is its name in messages, and includes come from
/// `include_paths`.
Result<TypeFile> parse_type_xml(std::string_view text, std::string_view name,
                                const std::vector<std::filesystem::path>& include_paths = {});

}  // namespace engram::idf
