// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/deprecated.h"

#include <set>
#include <string>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"

namespace engram {

namespace {

/// A server reads its configuration repeatedly: one warning per place is enough.
///
/// Threading: thread-safe.
class ToldPlaces {
 public:
  /// Returns true the first time.
  bool add(std::string_view where) {
    const MutexLock lock(mutex_);
    return told_.emplace(where).second;
  }

 private:
  Mutex mutex_;
  std::set<std::string, std::less<>> told_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace

void warn_deprecated(const DeprecatedWord& word, std::string_view where) {
  static ToldPlaces told;
  if (!told.add(where)) return;
  log::warning("'{}': '{}' is deprecated and gone in version {}; write '{}' instead", where,
               word.old_word, word.gone_in, word.word);
}

}  // namespace engram
