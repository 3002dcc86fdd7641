// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace engram::speech {

/// A verb that English has for what a skill does. It is a fact of the language and not of a robot:
/// a skill whose name none of these has is called by its name.
struct SkillVerb {
  std::string_view base;    ///< "pick up"
  std::string_view past;    ///< "picked up"
  std::string_view gerund;  ///< "picking up"
  std::string_view to;      ///< How a place follows: "from", "on", "to", "at".
  std::string_view thing;   ///< What stands between verb and thing: "for" of "look for"; or empty.
  /// The first words of names and of questions that mean it, without endings: "pick grasp grab".
  std::string_view lemmas;
};

[[nodiscard]] std::span<const SkillVerb> skill_verbs();

/// The verb that a skill's name has a word of: "pick" and "pick_up" are "pick up". Null: none.
[[nodiscard]] const SkillVerb* verb_of_skill(std::string_view skill);

/// Whether `lemma` is one of the verb's lemmas.
[[nodiscard]] bool has_lemma(const SkillVerb& verb, std::string_view lemma);

}  // namespace engram::speech
