// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace engram::idf {

/// A generated file of source code, which is not yet on disk.
struct GeneratedFile {
  std::string name;  ///< The file name without a directory: "kitchen.h".
  std::string text;

  friend bool operator==(const GeneratedFile&, const GeneratedFile&) = default;
};

}  // namespace engram::idf
