// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/written_value.h"

#include <charconv>
#include <set>

#include "ltm/core/utf8.h"
#include "ltm/idf/json.h"

namespace engram::memory {

using Json = nlohmann::ordered_json;

namespace {

/// The bound of nesting in JSON. The JSON of an IDF value at its own bound nests less deeply.
constexpr size_t kMaxLevels = 4 * idf::kMaxDepth;

/// An iterator that gives a parser one character after the other and counts lines.
class CountedText {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountedText(const char* at, int* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  CountedText& operator++() {
    // The parser may look at the character behind a number, so a line ends one character late.
    if (was_end_ && line_ != nullptr) ++*line_;
    was_end_ = *at_ == '\n';
    ++at_;
    return *this;
  }
  CountedText operator++(int) {
    CountedText before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const CountedText& a, const CountedText& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  int* line_;
  bool was_end_ = false;
};

std::string name_of_key(const std::string& key) {
  return key.starts_with("$$") ? key.substr(1) : key;
}

/// Walks over a JSON text and finds the first error, or the line of a path. The value is parsed by
/// itself: nlohmann's JSON objects keep no lines and accept a key twice.
class JsonChecker : public nlohmann::json_sax<Json> {
 public:
  explicit JsonChecker(std::vector<std::string> wanted = {}) : wanted_(std::move(wanted)) {}

  bool check(std::string_view text) {
    const CountedText begin(text.data(), &line_);
    const CountedText end(text.data() + text.size(), nullptr);
    return Json::sax_parse(begin, end, this);
  }

  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] const std::string& what() const { return what_; }
  /// The line of the part at the wanted path, or of the closest part around it.
  [[nodiscard]] int wanted_line() const { return wanted_line_; }

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool string(string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool start_object(std::size_t) override { return open(true); }
  bool start_array(std::size_t) override { return open(false); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& key) override {
    Open& map = open_.back();
    map.name = name_of_key(key);
    if (map.keys.insert(key).second) return true;
    what_ = fmt::format("found the key '{}' again", key);
    return false;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception& error) override {
    what_ = error.what();
    const size_t start = what_.find("] ");
    what_ =
        fmt::format("is no JSON: {}", start == std::string::npos ? what_ : what_.substr(start + 2));
    return false;
  }

 private:
  struct Open {
    bool is_map;
    size_t count = 0;
    std::string name = {};  ///< The key or index of the current entry.
    std::set<std::string> keys = {};
  };

  bool value() {
    if (!open_.empty() && !open_.back().is_map)
      open_.back().name = std::to_string(open_.back().count++);
    if (open_.size() <= wanted_.size() && open_.size() > wanted_found_ && is_on_wanted_path()) {
      wanted_found_ = open_.size();
      wanted_line_ = line_;
    }
    return true;
  }

  bool open(bool is_map) {
    if (open_.empty()) wanted_line_ = line_;
    value();
    if (open_.size() == kMaxLevels) {
      what_ = fmt::format("nests deeper than {} levels", kMaxLevels);
      return false;
    }
    open_.push_back({is_map});
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  [[nodiscard]] bool is_on_wanted_path() const {
    for (size_t i = 0; i < open_.size(); ++i)
      if (open_[i].name != wanted_[i]) return false;
    return true;
  }

  int line_ = 1;
  std::string what_;
  std::vector<Open> open_;
  std::vector<std::string> wanted_;
  size_t wanted_found_ = 0;
  int wanted_line_ = 1;
};

/// A part of a value and its name.
struct Part {
  std::string name;
  const Json* json = nullptr;
};

/// The first part that is no IDF value by itself; null where every part is one.
Part broken_part(const Json& json) {
  const bool is_tagged = json.is_object() && json.size() == 1 &&
                         json.begin().key().starts_with('$') &&
                         !json.begin().key().starts_with("$$");
  if (!json.is_structured() || is_tagged) return {};
  size_t index = 0;
  for (auto part = json.begin(); part != json.end(); ++part, ++index)
    if (!idf::from_json(*part).ok())
      return {json.is_array() ? std::to_string(index) : name_of_key(part.key()), &*part};
  return {};
}

/// The path of the deepest part that is known to be no IDF value.
std::string broken_path(const Json& json) {
  std::string path;
  for (Part part = broken_part(json); part.json != nullptr; part = broken_part(*part.json))
    path = idf::join_path(path, part.name);
  return path;
}

Json scalar_of(const ConfigValue& config) {
  if (!config.is_text()) return nullptr;
  if (!config.is_quoted()) {
    if (const auto value = config.boolean(); value.ok()) return *value;
    if (const auto value = config.integer(); value.ok()) return *value;
    if (const auto value = config.number(); value.ok()) return *value;
  }
  return config.text().value_or("");
}

Json json_of(const ConfigValue& config) {
  if (config.is_list()) {
    Json json = Json::array();
    const auto list = config.list();
    for (const ConfigValue& value : *list) json.push_back(json_of(value));
    return json;
  }
  if (!config.is_map()) return scalar_of(config);
  Json::object_t object;
  auto map = config.map();
  for (const std::string& key : map->keys()) {
    const auto value = map->find(key);
    object.emplace_back(key, value ? json_of(*value) : Json());
  }
  return Json(std::move(object));
}

/// The part at a path, or the closest part around it.
ConfigValue part_of(ConfigValue config, const std::vector<std::string>& path) {
  for (const std::string& name : path) {
    std::optional<ConfigValue> next;
    if (config.is_map()) {
      auto map = *config.map();
      next = map.find(name);
      if (!next) next = map.find("$" + name);
    } else if (config.is_list()) {
      size_t index = 0;
      const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), index);
      const auto list = *config.list();
      if (error == std::errc() && index < list.size()) next = list[index];
    }
    if (!next) break;
    config = *std::move(next);
  }
  return config;
}

}  // namespace

Result<WrittenValue> WrittenValue::parse_json(std::string text, std::string file) {
  WrittenValue value;
  value.file_ = std::move(file);
  value.json_text_ = std::move(text);
  JsonChecker checker;
  if (!checker.check(value.json_text_))
    return invalid_argument("{}:{}: {}", value.file_, checker.line(), checker.what());
  ENGRAM_RETURN_IF_ERROR(value.read(Json::parse(value.json_text_, nullptr, false)));
  return value;
}

Result<WrittenValue> WrittenValue::parse_yaml(std::string_view text, std::string file) {
  if (!is_utf8(text)) return invalid_argument("{}: is no UTF-8", file);
  WrittenValue value;
  value.file_ = std::move(file);
  ENGRAM_ASSIGN_OR_RETURN(value.config_, ConfigValue::parse(text, value.file_));
  ENGRAM_RETURN_IF_ERROR(value.read(json_of(*value.config_)));
  return value;
}

Status WrittenValue::read(const Json& json) {
  auto data = idf::from_json(json);
  if (!data.ok())
    return invalid_argument("{}", problem_at(broken_path(json), data.status().message()));
  data_ = *std::move(data);
  return {};
}

std::string WrittenValue::problem_at(std::string_view path, std::string_view message) const {
  const std::vector<std::string> names =
      path.empty() ? std::vector<std::string>() : idf::split_path(path);
  if (config_) return part_of(*config_, names).error(message).message();
  JsonChecker checker(names);
  checker.check(json_text_);
  return fmt::format("{}:{}: {}", file_, checker.wanted_line(), message);
}

}  // namespace engram::memory
