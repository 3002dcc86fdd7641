// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::ltm {

/// The text form of a codec with options. The codec that it names reads it once.
///
/// The form is `name`, `name:value` or `name:key=value,key=value`. A value without a key belongs to
/// the codec's main option. Values are whole numbers.
class CodecText {
 public:
  /// Errors: kInvalidArgument if the text is malformed or contains a key twice.
  static Result<CodecText> parse(std::string_view text);

  [[nodiscard]] const std::string& name() const { return name_; }

  [[nodiscard]] bool has(const std::string& key) const { return values_.contains(key); }

  /// Takes the value of `key`, or `fallback` if it is not given. With `is_main`, also takes a value
  /// without a key.
  /// Errors: kInvalidArgument if it is not a number from `min` to `max`.
  Result<int> take(const std::string& key, bool is_main, int fallback, int min, int max);

  /// Checks that all options were taken. Errors: kInvalidArgument naming an option that was not.
  [[nodiscard]] Status finish() const;

 private:
  std::string name_;
  std::map<std::string, int> values_;  // The main option has the empty key.
  std::string known_;                  // Names of the known options, for messages.
};

}  // namespace engram::ltm
