// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/sight_words.h"

#include <algorithm>

namespace engram::speech {

size_t place_among(std::vector<std::string>& words, const std::string& word) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<size_t>(found - words.begin());
  words.push_back(word);
  return words.size() - 1;
}

}  // namespace engram::speech
