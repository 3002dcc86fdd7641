// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "memory/memory.h"
#include "speech/language/asker.h"

namespace engram::speech {

/// Answers what a living robot is asked: the skill `speech/answer` of a server, which the memory
/// starts by itself for words in `Speech/Commands` that end with a question mark. What is said is
/// committed to `Speech/Answers`, with links to the words and to the evidence.
///
/// A question is answered as of the moment at which it was asked. Not to know is an answer; the
/// skill fails where the memory does, or where `words` is no link to words.
///
/// Owns: its connections to the server.
/// Threading: thread-safe. Questions are answered one after the other.
/// Source: docs/verbalisation.md, section "On a living robot".
class AnswerSkill {
 public:
  struct Options {
    Asker::Options asker;
    ConnectOptions connect{};
    /// Called with each answer once it is committed, one at a time; may be empty.
    std::function<void(const Answer&)> on_answer{};
  };

  /// Connects to a server and registers the skill there.
  /// Errors: those of Memory::connect and SkillProvider::connect; kAlreadyExists if somebody else
  /// answers there.
  static Result<std::unique_ptr<AnswerSkill>> provide(const std::string& endpoint,
                                                      const Options& options);

  virtual ~AnswerSkill() = default;

  /// How many questions were answered so far, those that were not understood included.
  [[nodiscard]] virtual size_t answered() const = 0;
};

}  // namespace engram::speech
