// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::ltm {

/// The text form of a codec with options, read once by the codec that it names.
///
/// `name`, `name:value` or `name:key=value,key=value`; the value without a key is that of the
/// codec's main option. Whole numbers only.
class CodecText {
 public:
  /// Errors: kInvalidArgument where the text is malformed or names a key twice.
  static Result<CodecText> parse(std::string_view text);

  [[nodiscard]] const std::string& name() const { return name_; }

  [[nodiscard]] bool has(const std::string& key) const { return values_.contains(key); }

  /// Takes the value of `key`, or `fallback` where it was not given. `is_main` takes a value
  /// without a key too.
  /// Errors: kInvalidArgument where it is no number of `min` to `max`.
  Result<int> take(const std::string& key, bool is_main, int fallback, int min, int max);

  /// Errors: kInvalidArgument naming an option that nobody took.
  [[nodiscard]] Status finish() const;

 private:
  std::string name_;
  std::map<std::string, int> values_;  // The main option has the empty key.
  std::string known_;                  // For messages.
};

}  // namespace engram::ltm
