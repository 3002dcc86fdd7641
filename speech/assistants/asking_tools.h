// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "speech/assistants/memory_tool.h"
#include "speech/language/asker.h"

namespace engram::speech {

/// The tools that understand what a robot does: ask, which answers a question in English, and
/// timeline, which tells what was done in a time. They tell the snapshots that show it.
///
/// Threading: one thread calls them. Owns: `asker`, whose memory must outlive them.
/// Source: docs/assistants.md.
[[nodiscard]] std::vector<MemoryTool> asking_tools(std::shared_ptr<Asker> asker);

}  // namespace engram::speech
