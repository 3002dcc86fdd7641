// SPDX-License-Identifier: Apache-2.0
// The tree behind ConfigValue, for the files that build and read it.
#pragma once

#include <string>
#include <vector>

#include "ltm/core/config.h"

namespace engram {

struct ConfigValue::Node {
  enum class Kind { kNull, kText, kList, kMap };
  struct Entry;

  Kind kind = Kind::kNull;
  int line = 1;
  bool is_quoted = false;
  std::string text;
  std::vector<Entry> entries;  ///< Keys are empty in lists.
};

struct ConfigValue::Node::Entry {
  std::string key;
  Node value;
};

struct ConfigValue::Root {
  std::string name;
  Node node;
};

/// Reads a file of at most ConfigValue::kMaxBytes.
Result<std::string> read_config_text(const std::filesystem::path& path);

}  // namespace engram
