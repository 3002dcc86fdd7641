// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "cli/command.h"
#include "speech/learning/learn_to_answer.h"

namespace engram::cli {

/// What came of learning to answer, as lines and as JSON.
[[nodiscard]] std::string lesson_text(const speech::LessonReport& report,
                                      const std::filesystem::path& file);
[[nodiscard]] Json lesson_json(const speech::LessonReport& report,
                               const std::filesystem::path& file);

}  // namespace engram::cli
