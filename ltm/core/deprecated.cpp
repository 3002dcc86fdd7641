// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/deprecated.h"

#include <mutex>
#include <set>
#include <string>

#include "ltm/core/log.h"

namespace engram {

void warn_deprecated(const DeprecatedWord& word, std::string_view where) {
  // A server reads its configuration again and again: one warning is enough.
  static std::mutex mutex;
  static std::set<std::string, std::less<>> told;
  const std::scoped_lock lock(mutex);
  if (!told.emplace(where).second) return;
  log::warning("'{}': '{}' is deprecated and gone in version {}; write '{}' instead", where,
               word.old_word, word.gone_in, word.word);
}

}  // namespace engram
