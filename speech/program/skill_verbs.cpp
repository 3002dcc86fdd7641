// SPDX-License-Identifier: Apache-2.0
#include "speech/program/skill_verbs.h"

#include <algorithm>
#include <array>

#include "ltm/core/ascii.h"

namespace engram::speech {

namespace {

constexpr std::array<SkillVerb, 10> kSkillVerbs{{
    {"pick up", "picked up", "picking up", "from", "",
     "pick pickup grasp grab take lift grip fetch collect get seize remove"},
    {"place", "placed", "placing", "on", "",
     "place put set lay deposit release drop putdown setdown leave deliver"},
    {"drive", "drove", "driving", "to", "for",
     "navigate drive move go travel approach head roll walk visit come"},
    {"look", "looked", "looking", "at", "for",
     "look search seek inspect watch find locate scan spot hunt"},
    {"open", "opened", "opening", "at", "", "open unlock"},
    {"close", "closed", "closing", "at", "", "close shut lock"},
    {"pour", "poured", "pouring", "at", "", "pour fill"},
    {"push", "pushed", "pushing", "at", "", "push shove press"},
    {"hand over", "handed over", "handing over", "at", "", "handover give pass"},
    {"wipe", "wiped", "wiping", "at", "", "wipe clean"},
}};

/// Calls `visit` with each word of a list until it returns true.
template <typename Visit>
bool any_word(std::string_view list, std::string_view separators, const Visit& visit) {
  while (!list.empty()) {
    const size_t end = std::min(list.find_first_of(separators), list.size());
    if (end > 0 && visit(list.substr(0, end))) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

}  // namespace

std::span<const SkillVerb> skill_verbs() {
  return kSkillVerbs;
}

bool has_lemma(const SkillVerb& verb, std::string_view lemma) {
  return any_word(verb.lemmas, " ", [&](std::string_view known) { return known == lemma; });
}

const SkillVerb* verb_of_skill(std::string_view skill) {
  const std::string lower = lower_ascii(skill.substr(skill.rfind('/') + 1));
  for (const SkillVerb& verb : kSkillVerbs)
    if (any_word(lower, "_- ", [&](std::string_view word) { return has_lemma(verb, word); }))
      return &verb;
  return nullptr;
}

}  // namespace engram::speech
