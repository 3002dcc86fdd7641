// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "memory/memory.h"
#include "speech/assistants/memory_tool.h"

namespace engram::speech {

/// The tools of any memory: entities, query, near, similar, why and picture. They read and never
/// write. An answer has at most some hundred thousand characters; what is left out is counted.
///
/// Threading: one thread calls them. Owns: nothing; `memory` must outlive them.
/// Source: docs/assistants.md.
[[nodiscard]] std::vector<MemoryTool> memory_tools(Memory& memory);

}  // namespace engram::speech
