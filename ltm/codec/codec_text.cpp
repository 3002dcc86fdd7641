// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/codec_text.h"

#include <charconv>
#include <optional>

namespace engram::ltm {

namespace {

std::optional<int> parse_int(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Result<CodecText> CodecText::parse(std::string_view text) {
  CodecText parsed;
  const size_t colon = text.find(':');
  parsed.name_ = text.substr(0, colon);
  if (parsed.name_.empty()) return invalid_argument("codec '{}': needs a name", text);
  if (colon == std::string_view::npos) return parsed;
  for (size_t start = colon + 1; start <= text.size();) {
    const size_t end = std::min(text.find(',', start), text.size());
    const std::string_view option = text.substr(start, end - start);
    const size_t equals = option.find('=');
    const bool has_key = equals != std::string_view::npos;
    const auto value = parse_int(has_key ? option.substr(equals + 1) : option);
    if (!value || (has_key && equals == 0))
      return invalid_argument("codec '{}': option '{}' is neither a number nor key=number", text,
                              option);
    if (!parsed.values_.emplace(has_key ? option.substr(0, equals) : "", *value).second)
      return invalid_argument("codec '{}': option '{}' is given twice", text, option);
    start = end + 1;
  }
  return parsed;
}

Result<int> CodecText::take(const std::string& key, bool is_main, int fallback, int min, int max) {
  known_ += (known_.empty() ? "'" : ", '") + key + "'";
  auto found = values_.find(key);
  if (found == values_.end() && is_main) found = values_.find("");
  if (found == values_.end()) return fallback;
  const int value = found->second;
  values_.erase(found);
  if (value < min || value > max)
    return invalid_argument("codec '{}': {} is {}, needs {} to {}", name_, key, value, min, max);
  return value;
}

Status CodecText::finish() const {
  if (values_.empty()) return {};
  const std::string& left = values_.begin()->first;
  return invalid_argument("codec '{}': has no option '{}', needs {}", name_,
                          left.empty() ? std::to_string(values_.begin()->second) : left,
                          known_.empty() ? "none" : "one of " + known_);
}

}  // namespace engram::ltm
