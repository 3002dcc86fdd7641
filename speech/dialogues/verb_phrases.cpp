// SPDX-License-Identifier: Apache-2.0
// English words for the skills of a kitchen.
#include <array>

#include "speech/dialogues/phrasings.h"

namespace engram::speech::dialogues {

namespace {

/// `*` stands for the thing, and `@` for the place.
struct VerbWords {
  std::string_view base;
  std::string_view past;
  std::string_view doing;
};

using Words = std::span<const VerbWords>;

constexpr std::array kPickThing{
    VerbWords{"pick up the *", "picked up the *", "picking up the *"},
    VerbWords{"grasp the *", "grasped the *", "grasping the *"},
    VerbWords{"grab the *", "grabbed the *", "grabbing the *"},
    VerbWords{"pick the * up", "picked the * up", "picking the * up"},
    VerbWords{"take the *", "took the *", "taking the *"},
    VerbWords{"lift the *", "lifted the *", "lifting the *"},
    VerbWords{"get hold of the *", "got hold of the *", "getting hold of the *"},
    VerbWords{"lift up the *", "lifted up the *", "lifting up the *"}};
constexpr std::array kPick{
    VerbWords{"pick something up", "picked something up", "picking something up"},
    VerbWords{"grasp something", "grasped something", "grasping something"},
    VerbWords{"grab something", "grabbed something", "grabbing something"},
    VerbWords{"pick up an object", "picked up an object", "picking up an object"},
    VerbWords{"take something", "took something", "taking something"}};
constexpr std::array kPlaceThing{
    VerbWords{"put down the *", "put down the *", "putting down the *"},
    VerbWords{"put the * down", "put the * down", "putting the * down"},
    VerbWords{"place the *", "placed the *", "placing the *"},
    VerbWords{"set down the *", "set down the *", "setting down the *"},
    VerbWords{"set the * down", "set the * down", "setting the * down"}};
constexpr std::array kPlaceThingThere{
    VerbWords{"put the * on the @", "put the * on the @", "putting the * on the @"},
    VerbWords{"place the * on the @", "placed the * on the @", "placing the * on the @"},
    VerbWords{"set the * down on the @", "set the * down on the @", "setting the * down on the @"},
    VerbWords{"put the * down on the @", "put the * down on the @", "putting the * down on the @"},
    VerbWords{"set the * on the @", "set the * on the @", "setting the * on the @"},
    VerbWords{"put the * onto the @", "put the * onto the @", "putting the * onto the @"}};
constexpr std::array kPlaceAny{
    VerbWords{"put something down", "put something down", "putting something down"},
    VerbWords{"place something", "placed something", "placing something"},
    VerbWords{"set something down", "set something down", "setting something down"}};
constexpr std::array kNavigateThere{
    VerbWords{"drive to the @", "drove to the @", "driving to the @"},
    VerbWords{"go to the @", "went to the @", "going to the @"},
    VerbWords{"move to the @", "moved to the @", "moving to the @"},
    VerbWords{"navigate to the @", "navigated to the @", "navigating to the @"},
    VerbWords{"travel to the @", "travelled to the @", "travelling to the @"},
    VerbWords{"go over to the @", "went over to the @", "going over to the @"},
    VerbWords{"drive over to the @", "drove over to the @", "driving over to the @"},
    VerbWords{"head to the @", "headed to the @", "heading to the @"}};
constexpr std::array kNavigate{VerbWords{"drive", "drove", "driving"},
                               VerbWords{"drive somewhere", "drove somewhere", "driving somewhere"},
                               VerbWords{"move somewhere", "moved somewhere", "moving somewhere"},
                               VerbWords{"navigate", "navigated", "navigating"},
                               VerbWords{"go somewhere", "went somewhere", "going somewhere"}};
constexpr std::array kLookThing{
    VerbWords{"look for the *", "looked for the *", "looking for the *"},
    VerbWords{"look at the *", "looked at the *", "looking at the *"},
    VerbWords{"search for the *", "searched for the *", "searching for the *"},
    VerbWords{"look around for the *", "looked around for the *", "looking around for the *"}};
constexpr std::array kLook{
    VerbWords{"look for something", "looked for something", "looking for something"},
    VerbWords{"search for something", "searched for something", "searching for something"},
    VerbWords{"look at something", "looked at something", "looking at something"}};

Words words_for(const Asked& asked) {
  const bool has_thing = !asked.thing.empty();
  const bool has_place = !asked.place.empty();
  if (asked.skill == "pick" && !has_place) return has_thing ? Words(kPickThing) : Words(kPick);
  if (asked.skill == "place" && has_place) return has_thing ? Words(kPlaceThingThere) : Words();
  if (asked.skill == "place") return has_thing ? Words(kPlaceThing) : Words(kPlaceAny);
  if (asked.skill == "navigate" && !has_thing)
    return has_place ? Words(kNavigateThere) : Words(kNavigate);
  if (asked.skill == "look" && !has_place) return has_thing ? Words(kLookThing) : Words(kLook);
  return {};
}

std::string with_names(std::string_view words, const Asked& asked) {
  std::string text;
  for (const char letter : words)
    if (letter == '*')
      text += asked.thing;
    else if (letter == '@')
      text += asked.place;
    else
      text += letter;
  return text;
}

/// The past participle, from the past: "taken" from "took".
std::string participle(std::string past) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kOthers{
      {{"took", "taken"}, {"went", "gone"}, {"drove", "driven"}}};
  for (const auto& [simple, perfect] : kOthers)
    if (past.starts_with(simple)) past.replace(0, simple.size(), perfect);
  return past;
}

}  // namespace

std::vector<VerbPhrase> verb_phrases(const Asked& asked) {
  std::vector<VerbPhrase> phrases;
  for (const VerbWords& words : words_for(asked))
    phrases.push_back({.id = fmt::format("{}{}{}.{}", asked.skill, asked.thing.empty() ? "" : "*",
                                         asked.place.empty() ? "" : "@", phrases.size()),
                       .base = with_names(words.base, asked),
                       .past = with_names(words.past, asked),
                       .done = participle(with_names(words.past, asked)),
                       .doing = with_names(words.doing, asked)});
  return phrases;
}

}  // namespace engram::speech::dialogues
