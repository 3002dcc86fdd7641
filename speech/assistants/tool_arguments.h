// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "speech/assistants/memory_tool.h"

namespace engram::speech {

/// Reads the arguments that an assistant gave a tool. They are as hostile as any input from
/// outside: what is missing, of another kind or unknown is an error that names the argument, what
/// was found and what was needed.
///
/// Errors of all readers: kInvalidArgument.
/// Threading: one thread.
class ToolArguments {
 public:
  /// `arguments` must outlive it. Anything but an object or null is an error of finish().
  explicit ToolArguments(const ToolJson& arguments) : arguments_(arguments) {}

  Result<std::string> text(const std::string& name);
  Result<std::string> text_or(const std::string& name, const std::string& otherwise);
  /// A finite number.
  Result<double> number(const std::string& name);
  Result<double> number_or(const std::string& name, double otherwise, double min, double max);
  Result<size_t> count_or(const std::string& name, size_t otherwise, size_t max);
  Result<std::optional<Time>> time(const std::string& name);
  /// The ID of an entity, or of anything in it.
  Result<ltm::MemoryId> id(const std::string& name);

  /// Errors: kInvalidArgument naming an argument that nobody read.
  [[nodiscard]] Status finish() const;

 private:
  const ToolJson* find(const std::string& name);
  [[nodiscard]] static Status wrong(const std::string& name, const ToolJson& found,
                                    std::string_view needed);

  const ToolJson& arguments_;
  std::set<std::string> known_;
};

}  // namespace engram::speech
