// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "ltm/core/status.h"

namespace engram::speech {

/// Members keep their order, which is what an assistant reads.
using ToolJson = nlohmann::ordered_json;

/// An image beside an answer, in a form that assistants look at.
struct ToolImage {
  std::string media_type;  ///< "image/jpeg".
  std::string base64;
};

struct ToolAnswer {
  ToolJson value;  ///< An object.
  std::optional<ToolImage> image{};
};

/// Something that an assistant, a language model on whatever machine, may ask a memory.
struct MemoryTool {
  std::string name;
  std::string title;
  std::string description;  ///< For the assistant: when to use it, and what comes back.
  ToolJson input_schema;    ///< A JSON schema of the arguments, an object.
  /// Errors go to the assistant, which may ask in another way.
  std::function<Result<ToolAnswer>(const ToolJson& arguments)> call;
};

}  // namespace engram::speech
