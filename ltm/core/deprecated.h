// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace engram {

/// A word that users write and that has another name now: a key of a configuration file or an
/// option of a command. The old one is accepted for two minor versions.
struct DeprecatedWord {
  std::string_view old_word;
  std::string_view word;     ///< What it is called now.
  std::string_view gone_in;  ///< The first version that does not know the old word, as "0.3".
};

/// Logs a warning that names both words and the version, once per process and place. `where` is the
/// place as the user sees it: "servers[0].working_memory.least", "recover --output".
/// Threading: thread-safe.
void warn_deprecated(const DeprecatedWord& word, std::string_view where);

}  // namespace engram
