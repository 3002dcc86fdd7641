// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ltm/idf/data.h"

namespace engram::idf {

/// Calls `visit(path, value)` with a value and with each one that it holds, each before its parts.
/// The visitor may change what it is given. Paths are those of Data::at.
template <typename Visit>
void walk_values(Data& value, const Visit& visit, const std::string& path = "") {
  visit(path, value);
  if (auto* list = value.get_if<List>()) {
    for (size_t i = 0; i < list->size(); ++i)
      walk_values((*list)[i], visit, join_path(path, std::to_string(i)));
  } else if (const auto* dict = value.get_if<Dict>()) {
    // A dict gives values to be changed by their keys alone, and finding each key takes linear
    // time; the dict itself may be changed here.
    for (const DictEntry& entry : *dict)
      walk_values(const_cast<Data&>(entry.value), visit, join_path(path, entry.key));
  }
}

}  // namespace engram::idf
