// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "speech/assistants/memory_tool.h"

namespace engram::speech {

/// A session of the Model Context Protocol, through which an assistant uses a memory: JSON-RPC 2.0,
/// a message at a time, whatever carries the messages.
///
/// Errors of a tool are results that say so, since the assistant can ask in another way. What is no
/// request at all gets an error of JSON-RPC; nothing that comes ends the session.
/// Threading: one thread.
/// Source: Model Context Protocol, revisions 2024-11-05, 2025-03-26 and 2025-06-18.
class McpSession {
 public:
  struct Options {
    std::string name = "engram";
    std::string version;
    std::string instructions;  ///< Of how to use the tools together.
  };

  /// Longer messages are refused. Unit: bytes.
  static constexpr size_t kMaxMessage = size_t{1} << 20;

  McpSession(std::vector<MemoryTool> tools, Options options);

  /// Answers a message. The answer is one line without its break; empty: none is wanted.
  std::string answer(std::string_view message);

 private:
  using Method = ToolJson (McpSession::*)(const ToolJson& request);

  /// Nothing (null) for a notification.
  ToolJson answer_one(const ToolJson& message);
  ToolJson initialize(const ToolJson& request);
  ToolJson ping(const ToolJson& request);
  ToolJson list_tools(const ToolJson& request);
  ToolJson call_tool(const ToolJson& request);

  const std::vector<MemoryTool> tools_;
  const Options options_;
  const std::map<std::string, Method, std::less<>> methods_;
  bool is_initialized_ = false;
};

}  // namespace engram::speech
