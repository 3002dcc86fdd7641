// SPDX-License-Identifier: Apache-2.0
#include "speech/program/filter_texts.h"

#include <algorithm>

namespace engram::speech {

std::vector<std::string> names_in_list(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const size_t comma = std::min(text.find(','), text.size());
    if (comma > 0) names.emplace_back(text.substr(0, comma));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return names;
}

std::string any_of_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

bool fits_outcome(std::string_view wanted, ltm::ActionOutcome outcome) {
  using ltm::ActionOutcome;
  if (wanted == "problem")
    return outcome == ActionOutcome::kFailure || outcome == ActionOutcome::kStop;
  if (wanted == "lost") return outcome == ActionOutcome::kUnknown;
  return ltm::name_of(outcome) == wanted;
}

}  // namespace engram::speech
