// SPDX-License-Identifier: Apache-2.0
#include "memory/live/subscription.h"

namespace engram {

namespace {

/// Each new entity is matched against all patterns of all subscriptions, so their number is
/// bounded.
constexpr size_t kMaxPatterns = 256;

}  // namespace

Result<ltm::Query> subscribed_names(const std::vector<std::string>& names) {
  if (names.size() > kMaxPatterns)
    return invalid_argument("subscription: found {} patterns of names, needs at most {}",
                            names.size(), kMaxPatterns);
  std::string text;
  for (const std::string& pattern : names) text += (text.empty() ? "" : " ; ") + pattern;
  return text.empty() ? ltm::Query() : ltm::Query::parse(text);
}

}  // namespace engram
