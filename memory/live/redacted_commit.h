// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what working memory does to a commit ahead of taking it.

#include <vector>

#include "ltm/memory/commit.h"
#include "ltm/recording/redaction_rules.h"

namespace engram::memory {

/// Redacts the updates of a commit and takes out those that are dropped. `encoded` is empty or has
/// the bytes of each instance of each update, as WorkingMemory::admit takes it.
///
/// Nothing that stays keeps the images alive as they came: bytes of a redacted update go, and other
/// arrays that lie in the same message or block are copied out of it.
void redact(ltm::Redactor& redactor, ltm::Commit& commit,
            std::vector<std::vector<Buffer>>& encoded);

}  // namespace engram::memory
