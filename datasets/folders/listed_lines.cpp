// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/listed_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

namespace engram::datasets {

namespace {

constexpr size_t kMaxLineBytes = 4096;
constexpr int64_t kNsPerSecond = 1'000'000'000;
constexpr int64_t kMostSeconds = 9'200'000'000;

std::optional<int64_t> whole_number(std::string_view text) {
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || value < 0)
    return std::nullopt;
  return value;
}

}  // namespace

std::optional<Time> time_from_decimal(std::string_view text) {
  const size_t dot = std::min(text.find('.'), text.size());
  std::string digits(dot < text.size() ? text.substr(dot + 1) : "0");
  // What is finer than a nanosecond is cut off.
  digits.resize(9, '0');
  const auto seconds = whole_number(text.substr(0, dot));
  const auto ns = whole_number(digits);
  if (!seconds || !ns || *seconds > kMostSeconds) return std::nullopt;
  return time_from_ns(*seconds * kNsPerSecond + *ns);
}

Result<Time> later(Time time, Duration more) {
  int64_t ns = 0;
  if (!__builtin_add_overflow(to_ns(time), more.count(), &ns)) return time_from_ns(ns);
  return invalid_argument("{} behind {} is behind the year 2262", to_string(more), to_string(time));
}

Result<ListedLines> ListedLines::open(const std::filesystem::path& path, size_t words) {
  std::error_code error;
  // A pipe would be waited for.
  if (!std::filesystem::is_regular_file(path, error))
    return not_found("'{}': is no file", path.string());
  std::ifstream file(path);
  if (!file) return not_found("'{}': cannot be opened", path.string());
  return ListedLines(path, std::move(file), words);
}

Result<std::optional<ListedLines::Line>> ListedLines::next() {
  std::array<char, kMaxLineBytes> buffer{};
  while (file_.getline(buffer.data(), buffer.size())) {
    ++number_;
    std::istringstream text(buffer.data());
    std::vector<std::string> words;
    for (std::string word; text >> word;) words.push_back(std::move(word));
    if (words.empty() || words.front().starts_with('#')) continue;
    const auto time = time_from_decimal(words.front());
    if (!time || words.size() != words_ + 1)
      return invalid_argument("'{}': line {} has {} words, needs a time in seconds and {}",
                              path_.string(), number_, words.size(), words_);
    words.erase(words.begin());
    return std::optional(Line{*time, std::move(words), number_});
  }
  if (!file_.eof())
    return invalid_argument("'{}': line {} has more than {} bytes", path_.string(), number_ + 1,
                            kMaxLineBytes - 1);
  return std::optional<Line>();
}

}  // namespace engram::datasets
