// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/phrasings.h"

#include <algorithm>
#include <map>
#include <set>

namespace engram::speech::dialogues {

namespace {

bool is_one_of(std::string_view what, std::initializer_list<std::string_view> all) {
  return std::find(all.begin(), all.end(), what) != all.end();
}

bool is_any_of(const std::set<std::string, std::less<>>& slots,
               std::initializer_list<std::string_view> all) {
  return std::any_of(all.begin(), all.end(),
                     [&](std::string_view one) { return slots.contains(one); });
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

/// Whether a text with these slots says all that the question is about.
bool tells_all(const std::set<std::string, std::less<>>& slots, const KnownAnswer& known) {
  const bool has_verb = is_any_of(slots, {"do", "did", "done", "doing"});
  if (!known.asked.thing.empty() && !has_verb && !slots.contains("thing")) return false;
  if (!known.asked.place.empty() && !has_verb && !slots.contains("place")) return false;
  if (known.slots.contains("at") && !is_any_of(slots, {"at", "time", "ago"})) return false;
  for (const char* name : {"when", "thing2", "hand", "person"}) {
    const auto slot = known.slots.find(name);
    if (slot != known.slots.end() && !slot->second.empty() && !slots.contains(name)) return false;
  }
  return true;
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
  if (is_choosing(asked.what) && !asked.which.empty()) form += ":" + asked.which;
  return form;
}

bool is_form(std::string_view form) {
  return phrasings_by_form().contains(form);
}

bool is_choosing(std::string_view what) {
  return is_one_of(what, {"when_did_you", "why_event", "how_long", "how_far_driven",
                          "what_was_asked", "which_thing", "to_where"});
}

std::optional<FilledText> filled_slots(std::string_view text, const KnownAnswer& known,
                                       const VerbPhrase& verb) {
  FilledText result;
  while (true) {
    const size_t open = text.find('{');
    result.text += text.substr(0, open);
    if (open == std::string_view::npos) return result;
    const size_t close = text.find('}', open);
    if (close == std::string_view::npos) return {};
    const std::string_view name = text.substr(open + 1, close - open - 1);
    const auto fill = filling(name, known, verb);
    if (!fill) return {};
    result.text += *fill;
    result.slots.emplace(name);
    text.remove_prefix(close + 1);
  }
}

std::vector<WordedQuestion> worded_by(std::string_view text, const std::string& id,
                                      const KnownAnswer& known) {
  std::vector<WordedQuestion> all;
  const bool has_verb = text.find("{do") != std::string_view::npos ||  // Also {done} and {doing}.
                        text.find("{did}") != std::string_view::npos;
  if (!has_verb) {
    auto result = filled_slots(text, known, {});
    if (result && tells_all(result->slots, known)) all.push_back({std::move(result->text), id});
    return all;
  }
  for (const VerbPhrase& verb : verb_phrases(known.asked)) {
    auto result = filled_slots(text, known, verb);
    if (result && tells_all(result->slots, known))
      all.push_back({std::move(result->text), id + "/" + verb.id});
  }
  return all;
}

std::vector<WordedQuestion> worded(const KnownAnswer& known) {
  std::vector<WordedQuestion> all;
  const std::string form = form_of(known.asked);
  const auto found = phrasings_by_form().find(form);
  if (found == phrasings_by_form().end()) return all;
  for (size_t i = 0; i < found->second.size(); ++i)
    for (WordedQuestion& one : worded_by(found->second[i], fmt::format("{}#{}", form, i), known))
      all.push_back(std::move(one));
  return all;
}

}  // namespace engram::speech::dialogues
