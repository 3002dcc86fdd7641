// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "speech/attention/attention_reader.h"

namespace engram::speech {

/// Opens a network of the route of attention. It is safe on hostile files.
/// Errors: kNotFound; kDataLoss if the file is damaged; kFailedPrecondition if another version of
/// this program wrote it, whose symbols or sizes are others.
Result<std::unique_ptr<AttentionNetwork>> load_attention(const std::filesystem::path& path);

}  // namespace engram::speech
