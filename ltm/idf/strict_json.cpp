// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/strict_json.h"

#include <nlohmann/json.hpp>
#include <string>
#include <unordered_set>
#include <vector>

namespace engram::idf {

namespace {

using StrictJson = nlohmann::ordered_json;

/// Reads a text once without building anything, so that deep nesting costs no stack later.
class StrictCheck final : public nlohmann::json_sax<StrictJson> {
 public:
  explicit StrictCheck(int max_levels) : max_levels_(static_cast<size_t>(max_levels)) {}

  [[nodiscard]] const Status& status() const { return status_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t& text) override {
    if (text.find_first_of(".eE") != std::string::npos) return true;
    return fail(invalid_argument("JSON: found the integer {}, needs one of 64 bits", text));
  }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }

  bool start_object(size_t) override { return start(); }
  bool end_object() override { return end(); }
  bool start_array(size_t) override { return start(); }
  bool end_array() override { return end(); }

  bool key(string_t& key) override {
    if (keys_.back().insert(key).second) return true;
    return fail(invalid_argument("JSON: found the key '{}' twice in an object", key));
  }

  bool parse_error(size_t, const std::string&, const nlohmann::detail::exception& error) override {
    return fail(invalid_argument("no JSON: {}", error.what()));
  }

 private:
  bool start() {
    if (keys_.size() >= max_levels_)
      return fail(invalid_argument("JSON nests deeper than {} levels", max_levels_));
    keys_.emplace_back();
    return true;
  }

  bool end() {
    keys_.pop_back();
    return true;
  }

  bool fail(Status status) {
    status_ = std::move(status);
    return false;
  }

  size_t max_levels_;
  /// The keys of each object that is open; nothing for a list.
  std::vector<std::unordered_set<std::string>> keys_;
  Status status_;
};

}  // namespace

Result<StrictJson> parse_json(std::string_view text, int max_levels) {
  try {
    StrictCheck check(max_levels);
    if (!StrictJson::sax_parse(text, &check)) return check.status();
    return StrictJson::parse(text);
  } catch (const StrictJson::exception& error) {
    return invalid_argument("no JSON: {}", error.what());
  }
}

}  // namespace engram::idf
