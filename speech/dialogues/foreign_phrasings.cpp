// SPDX-License-Identifier: Apache-2.0
// Questions in the words of others, who wrote what they ask for beside them.
#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "ltm/core/printable.h"
#include "speech/dialogues/chosen_dialogues.h"

namespace engram::speech {

namespace dialogues {

namespace {

using Json = nlohmann::ordered_json;

struct ForeignPhrasing {
  std::string question;
  std::string family;
  std::map<std::string, std::string> asks;

  [[nodiscard]] std::string ask(const char* name) const {
    const auto found = asks.find(name);
    return found == asks.end() ? std::string() : found->second;
  }
};

Result<ForeignPhrasing> read_phrasing(const std::string& line, size_t number) {
  const Json json = Json::parse(line, nullptr, false);
  const auto wrong = [&](const char* needed) {
    return invalid_argument("phrasings: line {} needs {}, found '{}'", number, needed,
                            printable(line.substr(0, 80)));
  };
  if (!json.is_object()) return wrong("an object");
  const auto question = json.find("question");
  const auto asks = json.find("asks");
  if (question == json.end() || !question->is_string()) return wrong("a text 'question'");
  if (asks == json.end() || !asks->is_object()) return wrong("an object 'asks'");
  ForeignPhrasing phrasing{.question = question->get<std::string>(), .family = {}, .asks = {}};
  if (const auto family = json.find("family"); family != json.end() && family->is_string())
    phrasing.family = family->get<std::string>();
  for (const auto& [name, value] : asks->items())
    phrasing.asks[name] = value.is_string() ? value.get<std::string>() : value.dump();
  if (phrasing.ask("what").empty()) return wrong("'what' within 'asks'");
  return phrasing;
}

Result<std::vector<ForeignPhrasing>> read_phrasings(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return unavailable("phrasings '{}': cannot be read", path.string());
  std::vector<ForeignPhrasing> all;
  size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    ENGRAM_ASSIGN_OR_RETURN(ForeignPhrasing one, read_phrasing(line, number));
    all.push_back(std::move(one));
  }
  return all;
}

/// What others call what is asked here. A form that is missing here has its own name there, too.
std::string own_what(const ForeignPhrasing& phrasing) {
  const std::string what = phrasing.ask("what");
  const bool has_thing = !phrasing.ask("thing").empty();
  if (what == "things_picked" || (what == "which_thing" && phrasing.ask("which").empty()))
    return "which_things";
  if (what == "why_failed" && !has_thing) return "why_failed_any";
  if (what == "held_at" && phrasing.ask("when") == "now") return "held_now";
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
  // These ask for another thing with "first" and "last" than without.
  static const std::set<std::string> kChoosing{"when_did_you",   "why_event",   "how_long",
                                               "how_far_driven", "which_thing", "what_was_asked",
                                               "to_where"};
  const std::string which = phrasing.ask("which");
  if (!kChoosing.contains(asked.what))
    return which.empty() || asked.which.empty() || which == asked.which;
  if (asked.which.empty()) {
    // The whole way, and not that of one drive.
    const bool is_sum = asked.what == "how_far_driven" && asked.place.empty();
    return which.empty() || !is_sum;
  }
  return which == asked.which && says_which(phrasing.question, which);
}

bool fits(const ForeignPhrasing& phrasing, const KnownAnswer& known) {
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

/// The text with its slots filled; nothing if the question has not got one of them.
std::optional<std::string> filled_foreign(const ForeignPhrasing& phrasing,
                                          const KnownAnswer& known) {
  std::string result;
  std::string_view text = phrasing.question;
  while (!text.empty()) {
    const size_t open = text.find('{');
    result += text.substr(0, open);
    if (open == std::string_view::npos) break;
    const size_t close = text.find('}', open);
    if (close == std::string_view::npos) return {};
    const std::string name(text.substr(open + 1, close - open - 1));
    text.remove_prefix(close + 1);
    const auto slot = known.slots.find(name);
    const std::string fill = name == "thing"             ? known.asked.thing
                             : name == "place"           ? known.asked.place
                             : slot != known.slots.end() ? slot->second
                                                         : std::string();
    if (fill.empty()) return {};
    result += fill;
  }
  // A day that is asked about must be told, unless the words tell it: "today".
  const std::string when = phrasing.ask("when");
  if (when == "today" && known.slots.contains("day") && known.slots.at("day") != "today") return {};
  return result;
}

/// What fills the words of questions that cannot be answered: any thing, place and time.
std::deque<KnownAnswer> fillings_of_unknown(const LivedPast& past,
                                            const std::deque<KnownAnswer>& known) {
  std::deque<KnownAnswer> fillings;
  for (const KnownAnswer& one : known) {
    if (!one.slots.contains("time") && !one.slots.contains("ago")) continue;
    for (const auto& [thing, sights] : past.sights) {
      KnownAnswer filling{.family = "unanswerable",
                          .asked = {.what = "unanswerable:foreign", .thing = thing},
                          .slots = one.slots,
                          .now = past.last_moment()};
      filling.asked.place = past.places.empty() ? "" : past.places.begin()->first;
      filling.slots["thing2"] = past.sights.begin()->first;
      fillings.push_back(std::move(filling));
    }
  }
  return fillings;
}

}  // namespace

std::vector<Dialogue> foreign_dialogues(const LivedPast& past, const DialogueOptions& options,
                                        const std::vector<ForeignPhrasing>& phrasings) {
  const std::deque<KnownAnswer> known = all_known(past, options);
  const std::deque<KnownAnswer> unknown = fillings_of_unknown(past, known);
  std::mt19937_64 random(options.seed);
  std::vector<Dialogue> made;
  for (size_t i = 0; i < phrasings.size(); ++i) {
    const ForeignPhrasing& phrasing = phrasings[i];
    const bool is_unknown = phrasing.ask("what") == "unanswerable";
    std::vector<std::pair<const KnownAnswer*, std::string>> fitting;
    for (const KnownAnswer& one : is_unknown ? unknown : known)
      if (is_unknown || fits(phrasing, one))
        if (auto text = filled_foreign(phrasing, one)) fitting.emplace_back(&one, *std::move(text));
    if (fitting.empty()) continue;
    const auto& [answer, text] = fitting[random() % fitting.size()];
    made.push_back(dialogue_of(past, *answer, {text, fmt::format("foreign#{}", i)}));
    made.back().family = is_unknown ? "unanswerable" : answer->family;
    made.back().held_out = {"phrasing"};
  }
  // A random part of them, where fewer are wanted.
  for (size_t i = made.size(); i > 1; --i) std::swap(made[i - 1], made[random() % i]);
  if (made.size() > options.count) made.resize(options.count);
  for (size_t i = 0; i < made.size(); ++i) made[i].id = fmt::format("{}-f{}", past.seed, i);
  return made;
}

}  // namespace dialogues

Result<std::vector<Dialogue>> make_dialogues_with(Memory& memory, const DialogueOptions& options,
                                                  const std::filesystem::path& phrasings) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(const auto read, dialogues::read_phrasings(phrasings));
  ENGRAM_ASSIGN_OR_RETURN(const dialogues::LivedPast past, dialogues::LivedPast::read(memory));
  return dialogues::foreign_dialogues(past, options, read);
}

}  // namespace engram::speech
