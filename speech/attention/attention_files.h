// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace engram::speech {

/// Where a store keeps what it learned of questions.
[[nodiscard]] inline std::filesystem::path attention_file(const std::filesystem::path& store) {
  return store / "answers" / "questions.attention";
}

}  // namespace engram::speech
