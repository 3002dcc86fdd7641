// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/deprecated.h"
#include "ltm/core/time.h"

namespace engram {

class ConfigMap;

/// One value of a configuration file: a text, a list or a map, with its place in the file.
///
/// The files are YAML, read strictly: one document, every key once, no anchors, aliases or tags, no
/// nested document markers. All errors are kInvalidArgument and name file, line and key, what was
/// found and what was needed.
/// Owns: its part of the file, shared. Copying is O(length of its key).
/// Threading: immutable.
class ConfigValue {
 public:
  static constexpr size_t kMaxBytes = size_t{1} << 20;
  static constexpr int kMaxDepth = 64;
  static constexpr size_t kMaxValues = 20'000;

  /// Reads a text; `name` is its name in errors. An empty text is an empty map.
  static Result<ConfigValue> parse(std::string_view text, std::string name);

  /// Reads a file.
  /// Errors: also kNotFound, kUnavailable.
  static Result<ConfigValue> read_file(const std::filesystem::path& path);

  [[nodiscard]] bool is_text() const;
  [[nodiscard]] bool is_list() const;
  [[nodiscard]] bool is_map() const;
  [[nodiscard]] bool is_quoted() const;  ///< A text in quotes, which is never a number.

  [[nodiscard]] Result<std::string> text() const;
  [[nodiscard]] Result<bool> boolean() const;   ///< true or false.
  [[nodiscard]] Result<double> number() const;  ///< Finite.
  [[nodiscard]] Result<int64_t> integer() const;
  /// As parse_duration, for example "200ms"; not negative.
  [[nodiscard]] Result<Duration> duration() const;

  /// The same, or the longest duration for the word `never`.
  [[nodiscard]] Result<Duration> duration_or_never() const;
  /// "64MiB"; units are B kB MB GB TB KiB MiB GiB TiB.
  [[nodiscard]] Result<uint64_t> bytes() const;
  /// "5Hz", "1kHz"; more than zero.
  [[nodiscard]] Result<double> rate_hz() const;
  [[nodiscard]] Result<std::vector<ConfigValue>> list() const;
  [[nodiscard]] Result<ConfigMap> map() const;

  /// An error at this value: "FILE:LINE: 'KEY': ...".
  [[nodiscard]] Status error(std::string_view message) const;

  /// Turns an error of another function into one at this value.
  [[nodiscard]] Status error(const Status& status) const;

 private:
  friend class ConfigMap;
  friend class ConfigParser;
  struct Node;
  struct Root;

  ConfigValue(std::shared_ptr<const Root> root, const Node* node, std::string key)
      : root_(std::move(root)), node_(node), key_(std::move(key)) {}

  [[nodiscard]] std::string found() const;
  [[nodiscard]] Status needs(std::string_view what) const;

  std::shared_ptr<const Root> root_;
  const Node* node_ = nullptr;
  std::string key_;  ///< The path from the top: "entities[0].match".
};

/// The entries of a map. It notes which keys were read: all others are unknown.
///
/// Threading: one thread.
class ConfigMap {
 public:
  /// The value of a key; nothing where it is absent or null.
  std::optional<ConfigValue> find(std::string_view key);

  /// Errors: kInvalidArgument where the key is absent or null.
  Result<ConfigValue> require(std::string_view key);

  /// Sets `out` if the key is present, as in `map.read("late", late, &ConfigValue::boolean)`.
  template <typename T, typename U>
  Status read(std::string_view key, T& out, Result<U> (ConfigValue::*as)() const) {
    const std::optional<ConfigValue> value = find(key);
    if (!value) return {};
    ENGRAM_ASSIGN_OR_RETURN(out, ((*value).*as)());
    return {};
  }

  /// Like find and read, for a key that was renamed: its old name is accepted with a warning.
  /// Errors: kInvalidArgument where both names are present.
  Result<std::optional<ConfigValue>> find(const DeprecatedWord& word);

  template <typename T, typename U>
  Status read(const DeprecatedWord& word, T& out, Result<U> (ConfigValue::*as)() const) {
    ENGRAM_ASSIGN_OR_RETURN(const std::optional<ConfigValue> value, find(word));
    if (!value) return {};
    ENGRAM_ASSIGN_OR_RETURN(out, ((*value).*as)());
    return {};
  }

  /// Fails where there is a key that was not read, and suggests the known key that is closest.
  [[nodiscard]] Status finish() const;

  /// The keys, in the order of the file.
  [[nodiscard]] std::vector<std::string> keys() const;

  [[nodiscard]] const ConfigValue& value() const { return value_; }

 private:
  friend class ConfigValue;
  explicit ConfigMap(ConfigValue value) : value_(std::move(value)) {}

  ConfigValue value_;
  std::set<std::string, std::less<>> known_;
};

/// The one of `known` that `word` was probably meant to be; nothing where none is close.
[[nodiscard]] std::optional<std::string> closest_word(std::string_view word,
                                                      const std::vector<std::string>& known);

}  // namespace engram
