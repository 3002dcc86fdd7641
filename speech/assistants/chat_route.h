// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "speech/assistants/http_post.h"
#include "speech/assistants/memory_tool.h"

namespace engram::speech {

/// What a language model said of a question, as far as it is backed by the memory.
struct ChatAnswer {
  /// False: it gave no evidence that it had been shown, and what it said is withheld.
  bool is_known = false;
  std::string text;
  std::vector<ltm::MemoryId> evidence;  ///< Snapshots that its tools had shown it.
  std::vector<std::string> looked_for;  ///< What it asked the memory, in words.
  std::string withheld;                 ///< Why its answer was withheld.
};

/// Asks a language model that has the tools of a memory: any server with the chat completions of
/// OpenAI, such as those of llama.cpp, Ollama and vLLM.
///
/// A model may make things up. So it has to name the snapshots that show what it says, and an
/// answer is told only if the memory really showed it those in this conversation. Threading: one
/// thread. Source: docs/assistants.md, section "A language model of one's own".
class ChatRoute {
 public:
  struct Options {
    std::string url = "http://127.0.0.1:8080/v1";  ///< Without /chat/completions.
    std::string model;                             ///< Empty: the server's own.
    std::string token{};
    Duration timeout = std::chrono::minutes(2);  ///< For each turn.
    int max_turns = 8;                           ///< How often it may ask the memory.

    /// Errors: kInvalidArgument.
    [[nodiscard]] Status validate() const;
  };

  using Post = std::function<Result<HttpReply>(const HttpPost&, const std::stop_token&)>;

  /// `post` carries messages; another one is for tests.
  /// Errors: kInvalidArgument if the options do not validate.
  static Result<ChatRoute> create(Options options, std::vector<MemoryTool> tools,
                                  Post post = speech::post);

  /// Errors: kUnavailable if the server does not answer, or with something else; kCancelled. What
  /// the model does wrong is no error: then nothing is known.
  Result<ChatAnswer> ask(const std::string& question, Time now, const std::stop_token& stop = {});

 private:
  ChatRoute(Options options, std::vector<MemoryTool> tools, Post post);

  /// The model's next message.
  Result<ToolJson> complete(const ToolJson& messages, bool may_use_tools,
                            const std::stop_token& stop) const;

  Options options_;
  std::vector<MemoryTool> tools_;
  Post post_;
};

}  // namespace engram::speech
