// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: values that people write by hand, in JSON or YAML.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/config.h"
#include "ltm/idf/data.h"

namespace engram::memory {

/// The value of a file, with the lines of its parts.
///
/// JSON is IDF's JSON form. YAML is converted to it: maps, lists and texts; without quotes also
/// true, false, null and numbers.
class WrittenValue {
 public:
  /// Errors: kInvalidArgument as "FILE:LINE: ..." where it is no JSON or YAML, has a key twice, or
  /// is no IDF value.
  static Result<WrittenValue> parse_json(std::string text, std::string file);
  static Result<WrittenValue> parse_yaml(std::string_view text, std::string file);

  [[nodiscard]] const idf::Data& data() const { return data_; }

  /// Returns "FILE:LINE: message" for the part at a path, or for the closest part around it.
  [[nodiscard]] std::string problem_at(std::string_view path, std::string_view message) const;

 private:
  WrittenValue() = default;
  Status read(const nlohmann::ordered_json& json);

  std::string file_;
  std::string json_text_;              ///< The text of a JSON file.
  std::optional<ConfigValue> config_;  ///< The tree of a YAML file.
  idf::Data data_;
};

}  // namespace engram::memory
