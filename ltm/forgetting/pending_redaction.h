// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a redaction of a store has recorded anew, until the originals are
// gone.

#include <filesystem>

#include "ltm/store/rewrite.h"

namespace engram::ltm {

/// The snapshots whose originals may still be in the store. None where there is no such file.
/// Errors: kDataLoss if the file is damaged; kUnavailable.
Result<ForgetSet> read_pending_redaction(const std::filesystem::path& store);

/// Replaces the file, which is on the disk after ok. An empty set removes it.
/// Errors: kUnavailable, kResourceExhausted.
Status write_pending_redaction(const std::filesystem::path& store, const ForgetSet& pending);

}  // namespace engram::ltm
