// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace engram::idf {

/// A file of source code that a generator made, and nobody wrote yet.
struct GeneratedFile {
  std::string name;  ///< File name without a directory: "kitchen.h".
  std::string text;

  friend bool operator==(const GeneratedFile&, const GeneratedFile&) = default;
};

}  // namespace engram::idf
