// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "speech/program/program.h"

namespace engram::speech {

/// What a program looks for, in words: "executions of pick with the salt that failed, yesterday".
[[nodiscard]] std::string looked_for(const Program& program);

}  // namespace engram::speech
