// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/poke.h"

#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "ltm/core/printable.h"

namespace engram::datasets::kitchen {

namespace {

Status wrong_poke(std::string_view text, std::string_view found) {
  return invalid_argument(
      "poke '{}': found {}, needs 'chair to X,Y', 'person to X,Y,DEGREES', 'chair away', or "
      "'salt to table'",
      printable(text), found);
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// Reads numbers that commas separate; nothing where something else is there.
std::vector<double> read_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (size_t from = 0; from <= text.size();) {
    const size_t end = std::min(text.find(',', from), text.size());
    const std::string_view part = trimmed(text.substr(from, end - from));
    double number = 0;
    const auto [rest, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    if (error != std::errc() || rest != part.data() + part.size() || !std::isfinite(number))
      return {};
    numbers.push_back(number);
    from = end + 1;
  }
  return numbers;
}

}  // namespace

Result<Poke> parse_poke(std::string_view text) {
  constexpr std::string_view kTo = " to ";
  constexpr std::string_view kAway = " away";
  constexpr size_t kMaxLength = 200;
  if (text.size() > kMaxLength)
    return invalid_argument("poke: found {} letters, needs {} at most", text.size(), kMaxLength);
  const std::string_view all = trimmed(text);
  Poke poke;
  if (all.ends_with(kAway)) {
    poke.name = trimmed(all.substr(0, all.size() - kAway.size()));
    poke.is_away = true;
    if (poke.name.empty()) return wrong_poke(text, "no name");
    return poke;
  }
  const size_t to = all.rfind(kTo);
  if (to == std::string_view::npos) return wrong_poke(text, "neither 'to' nor 'away'");
  poke.name = trimmed(all.substr(0, to));
  if (poke.name.empty()) return wrong_poke(text, "no name");
  const std::string_view where = trimmed(all.substr(to + kTo.size()));
  for (const Surface surface : {Surface::kCounter, Surface::kTable})
    if (where == place_of(surface).name || where == place_of(surface).spoken_name)
      poke.surface = surface;
  if (poke.surface) return poke;
  const std::vector<double> numbers = read_numbers(where);
  if (numbers.size() != 2 && numbers.size() != 3)
    return wrong_poke(text, fmt::format("the place '{}'", printable(where)));
  poke.at.head<2>() << numbers[0], numbers[1];
  if (numbers.size() == 3) poke.at.z() = numbers[2] * std::numbers::pi / 180;
  return poke;
}

bool is_called(const ThingClass& type, std::string_view name) {
  return name == type.name || name == type.spoken_name || name == std::string(type.name) + "_1";
}

}  // namespace engram::datasets::kitchen
