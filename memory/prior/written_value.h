// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: values that people write, in JSON or YAML.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/config.h"
#include "ltm/idf/data.h"

namespace engram::memory {

/// The value in a file, which knows where its parts stand.
///
/// JSON is IDF's JSON form; YAML is converted to it: maps, lists, texts; without quotes true,
/// false, null and numbers.
class WrittenValue {
 public:
  /// Errors: kInvalidArgument as "FILE:LINE: ...": no JSON or YAML, a key that is there twice, no
  /// IDF value.
  static Result<WrittenValue> parse_json(std::string text, std::string file);
  static Result<WrittenValue> parse_yaml(std::string_view text, std::string file);

  [[nodiscard]] const idf::Data& data() const { return data_; }

  /// "FILE:LINE: message", for the part at a path or the one around it.
  [[nodiscard]] std::string problem_at(std::string_view path, std::string_view message) const;

 private:
  WrittenValue() = default;
  Status read(const nlohmann::ordered_json& json);

  std::string file_;
  std::string json_text_;              ///< Of JSON.
  std::optional<ConfigValue> config_;  ///< Of YAML.
  idf::Data data_;
};

}  // namespace engram::memory
