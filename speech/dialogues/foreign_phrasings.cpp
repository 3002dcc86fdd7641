// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/foreign_phrasings.h"

#include <algorithm>
#include <set>

namespace engram::speech::dialogues {

namespace {

/// What others call what is asked here. A form that is missing here has its own name there, too.
std::string own_what(const ForeignPhrasing& phrasing) {
  const std::string what = phrasing.ask("what");
  const bool has_thing = !phrasing.ask("thing").empty();
  if (what == "things_picked" || (what == "which_thing" && phrasing.ask("which").empty()))
    return "which_things";
  if (what == "why_failed" && !has_thing) return "why_failed_any";
  for (const char* past : {"held", "doing", "where_robot"})
    if (what == std::string(past) + "_at" && phrasing.ask("when") == "now")
      return std::string(past) + "_now";
  if (what == "is_visible" && phrasing.ask("when") != "now") return "was_visible_at";
  if (what == "things_on_place" && phrasing.ask("when") != "now") return "things_on_place_at";
  if (what == "what_did_you_do" && has_thing) return "what_did_you_do_with";
  if (what == "did_you" && phrasing.ask("outcome") == "failure")
    return has_thing ? "did_fail" : "any_failure";
  if (what == "what_if_not_stopped_next") return "what_next_if_not_stopped";
  if (what == "where_thing_if_not_stopped") return "where_to_if_not_stopped_thing";
  if (what.starts_with("what_if_not_") && has_thing) return what + "_thing";
  // The next step alone is asked for.
  if (what.starts_with("what_if_not_") && phrasing.question.find(" next") != std::string::npos)
    return "what_next_if" + what.substr(std::string_view("what_if").size());
  return what;
}

bool fits_skill(const ForeignPhrasing& phrasing, const Asked& asked) {
  const std::string skill = phrasing.ask("skill");
  if (asked.what == "which_things") return asked.skill == (skill.empty() ? "pick" : skill);
  const bool is_any = skill.empty() || skill == "any";
  return is_any ? asked.skill.empty() || asked.skill == "any" || asked.what == "retried"
                : asked.skill == skill;
}

/// How a span or a moment is put there, as it is here.
std::string own_when(std::string when) {
  if (when.empty() || when == "start") return "all";
  if (when == "today") return "{day}";
  if (when == "around_{time}") return "{time}";
  return when;
}

/// Whether a question asks for nothing that is not compared here, such as a person or a second
/// skill, and for the outcome that is asked for here.
bool is_plain(const ForeignPhrasing& phrasing, const Asked& asked) {
  static const std::set<std::string> kCompared{"what", "skill", "outcome", "which",
                                               "when", "thing", "place",   "thing2"};
  for (const auto& [name, value] : phrasing.asks)
    if (!kCompared.contains(name) && !(name == "hand" && asked.what == "was_hand")) return false;
  const std::string outcome = phrasing.ask("outcome");
  if (outcome.empty() || outcome == asked.outcome) return true;
  // Where nothing is said of the outcome, all attempts succeeded; but not of what was done in all.
  if (outcome == "success") return asked.outcome.empty() && asked.what != "what_did_you_do";
  return outcome == "failure" && (asked.what == "retried" || asked.what == "did_fail");
}

/// Whether the words themselves say which of several is meant. Where others wrote beside them that
/// it is the last, but did not say so, the words mean that only if there is no other.
bool says_which(const std::string& question, const std::string& which) {
  static const std::map<std::string, std::vector<std::string>> kWords{
      {"first", {"first", "begin", "start", "initial"}},
      {"last", {"last", "latest", "recent", "just now", "final", "newest"}}};
  const auto words = kWords.find(which);
  return words != kWords.end() &&
         std::any_of(words->second.begin(), words->second.end(), [&](const std::string& word) {
           return question.find(word) != std::string::npos;
         });
}

bool fits_choice(const ForeignPhrasing& phrasing, const Asked& asked) {
  const std::string which = phrasing.ask("which");
  if (!is_choosing(asked.what)) return which.empty() || asked.which.empty() || which == asked.which;
  if (asked.which.empty()) {
    // The whole way, and not that of one drive.
    const bool is_sum = asked.what == "how_far_driven" && asked.place.empty();
    return which.empty() || !is_sum;
  }
  return which == asked.which && says_which(phrasing.question, which);
}

bool fits_asks(const ForeignPhrasing& phrasing, const KnownAnswer& known) {
  const Asked& asked = known.asked;
  if (!is_plain(phrasing, asked)) return false;
  if (phrasing.ask("thing2").empty() != !known.slots.contains("thing2")) return false;
  if (asked.what != own_what(phrasing) || !fits_skill(phrasing, asked)) return false;
  if (phrasing.ask("thing").empty() != asked.thing.empty()) return false;
  if (phrasing.ask("place").empty() != asked.place.empty()) return false;
  if (own_when(phrasing.ask("when")) != asked.when) return false;
  if (!fits_choice(phrasing, asked)) return false;
  static const std::set<std::string> kCounting{"how_often", "did_you", "what_did_you_do"};
  if (!kCounting.contains(asked.what)) return true;
  const std::string outcome = phrasing.ask("outcome");
  return outcome == asked.outcome || (outcome == "success" && asked.outcome.empty());
}

}  // namespace

bool fits(const ForeignPhrasing& phrasing, const KnownAnswer& known) {
  if (phrasing.form.empty()) return phrasing.is_unanswerable() || fits_asks(phrasing, known);
  // Some are asked of no skill: a thing that nobody knows was never picked up.
  const std::string& skill = known.asked.skill;
  return form_of(known.asked) == phrasing.form &&
         (phrasing.skill.empty() || skill.empty() || skill == phrasing.skill);
}

std::vector<WordedQuestion> worded_with(const ForeignPhrasing& phrasing, const KnownAnswer& known) {
  if (!phrasing.form.empty()) return worded_by(phrasing.question, phrasing.phrasing, known);
  auto filled = filled_slots(phrasing.question, known, {});
  if (!filled) return {};
  // A day that is asked about must be told, unless the words tell it: "today".
  const auto day = known.slots.find("day");
  if (phrasing.ask("when") == "today" && day != known.slots.end() && day->second != "today")
    return {};
  return {{std::move(filled->text), phrasing.phrasing}};
}

}  // namespace engram::speech::dialogues
