// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace engram::speech {

/// What can be told of things in images. Entities are named by their IDs as texts.
struct SightWords {
  std::vector<std::string> kinds;  ///< Entities of classes: "Objects/Classes/kitchen/tea_box".
  /// Entities of places, and hands by their words; the first is empty: somewhere else.
  std::vector<std::string> where{""};
  std::vector<std::string> colours;  ///< "red"

  friend bool operator==(const SightWords&, const SightWords&) = default;
};

/// Where a word is among others, which it joins if it is not there.
[[nodiscard]] size_t place_among(std::vector<std::string>& words, const std::string& word);

}  // namespace engram::speech
