// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/phrasings.h"

#include <algorithm>
#include <array>
#include <map>

namespace engram::speech::dialogues {

namespace {

bool is_one_of(std::string_view what, std::initializer_list<std::string_view> all) {
  return std::find(all.begin(), all.end(), what) != all.end();
}

/// The phrasings of each form.
const std::map<std::string_view, std::vector<std::string_view>>& phrasings_by_form() {
  static const auto kAll = [] {
    std::map<std::string_view, std::vector<std::string_view>> all;
    for (const auto part :
         {object_phrasings(), event_phrasings(), reason_phrasings(), detail_phrasings(),
          moment_phrasings(), problem_phrasings(), unknown_phrasings(), instead_phrasings()})
      for (const Phrasing& one : part) all[one.form].push_back(one.text);
    return all;
  }();
  return kAll;
}

/// What replaces `{name}`; nothing if the question has no such thing.
std::optional<std::string> filling(std::string_view name, const KnownAnswer& known,
                                   const VerbPhrase& verb) {
  const Asked& asked = known.asked;
  const auto given = [](const std::string& text) {
    return text.empty() ? std::nullopt : std::optional(text);
  };
  if (name == "do") return given(verb.base);
  if (name == "did") return given(verb.past);
  if (name == "done") return given(verb.done);
  if (name == "doing") return given(verb.doing);
  if (name == "thing") return given(asked.thing);
  if (name == "place") return given(asked.place);
  const auto slot = known.slots.find(std::string(name));
  if (slot != known.slots.end()) return slot->second;
  return name == "when" ? std::optional(std::string()) : std::nullopt;
}

/// The text with all slots filled; nothing if it has a slot that the question does not fill, or
/// lacks one that the question is about.
std::optional<std::string> filled(std::string_view text, const KnownAnswer& known,
                                  const VerbPhrase& verb) {
  std::string result;
  bool has_when = false;
  bool has_verb = false;
  bool has_thing = false;
  bool has_place = false;
  while (!text.empty()) {
    const size_t open = text.find('{');
    result += text.substr(0, open);
    if (open == std::string_view::npos) break;
    const size_t close = text.find('}', open);
    const std::string_view name = text.substr(open + 1, close - open - 1);
    const auto fill = filling(name, known, verb);
    if (!fill) return {};
    has_when = has_when || name == "when";
    has_verb = has_verb || name.starts_with("d");
    has_thing = has_thing || name == "thing";
    has_place = has_place || name == "place";
    result += *fill;
    text.remove_prefix(close + 1);
  }
  const auto when = known.slots.find("when");
  if (when != known.slots.end() && !when->second.empty() && !has_when) return {};
  if (!known.asked.thing.empty() && !has_verb && !has_thing) return {};
  if (!known.asked.place.empty() && !has_verb && !has_place) return {};
  return result;
}

}  // namespace

std::string form_of(const Asked& asked) {
  std::string form = asked.what;
  if (is_one_of(asked.what, {"which_thing", "which_things", "how_many_different_things",
                             "things_failed", "was_doing_at", "longest_event"}) ||
      (asked.what == "to_where" && asked.skill == "navigate") ||
      (asked.what == "how_many_failures" && !asked.skill.empty()))
    form += "/" + asked.skill;
  if (is_one_of(asked.what, {"which_thing", "which_things"}) && !asked.place.empty()) form += "@";
  if (is_one_of(asked.what, {"how_often", "did_you", "what_did_you_do"}) && !asked.outcome.empty())
    form += ":" + asked.outcome;
  if (is_one_of(asked.what, {"when_did_you", "why_event", "how_long", "how_far_driven",
                             "what_was_asked", "which_thing", "to_where"}) &&
      !asked.which.empty())
    form += ":" + asked.which;
  return form;
}

std::vector<WordedQuestion> worded(const KnownAnswer& known) {
  std::vector<WordedQuestion> all;
  const std::string form = form_of(known.asked);
  const auto found = phrasings_by_form().find(form);
  if (found == phrasings_by_form().end()) return all;
  const std::vector<VerbPhrase> verbs = verb_phrases(known.asked);
  for (size_t i = 0; i < found->second.size(); ++i) {
    const std::string_view text = found->second[i];
    const std::string id = fmt::format("{}#{}", form, i);
    if (text.find("{d") == std::string_view::npos) {
      if (auto result = filled(text, known, {})) all.push_back({*std::move(result), id});
      continue;
    }
    for (const VerbPhrase& verb : verbs)
      if (auto result = filled(text, known, verb))
        all.push_back({*std::move(result), id + "/" + verb.id});
  }
  return all;
}

}  // namespace engram::speech::dialogues
