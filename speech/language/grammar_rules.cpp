// SPDX-License-Identifier: Apache-2.0
#include "speech/language/grammar_rules.h"

#include <algorithm>

namespace engram::speech {

namespace {

/// The skills of a verb; a verb whose skill the memory does not have is named as it is, so that the
/// program says so.
std::string skills_or_word(const Lexicon& lexicon, const TaggedWord& word) {
  const std::string skills = lexicon.skills_of(*word.verb);
  return skills.empty() ? word.lemma : skills;
}

/// Whether "it" is what something is done to: not in "how long did it take", "how far was it to".
bool has_object_it(const ClauseParts& clause) {
  bool is_behind_verb = false;
  for (const TaggedWord& word : clause.words) {
    if (word.text == "it" && is_behind_verb) return true;
    const bool is_deed =
        word.tag == WordTag::kVerb ||
        is_any(word.lemma, {"bring", "carry", "move", "shift", "transport", "use"});
    if (is_deed && word.lemma != "take") is_behind_verb = true;
    if (word.lemma == "take" && !clause.has_any({"how_long", "long", "longer"}))
      is_behind_verb = true;
  }
  return false;
}

/// Whether a clause says that something is done to a thing. "How long did it take" is of no thing.
bool names_thing(const ClauseParts& clause) {
  return !clause.things.empty() || has_object_it(clause) ||
         clause.has_any({"them", "something", "anything", "thing", "object"});
}

bool is_carrying(std::string_view lemma) {
  return is_any(lemma, {"move", "bring", "carry", "transport", "shift", "relocate", "deliver",
                        "take", "get", "transfer"});
}

}  // namespace

std::string GrammarRules::thing() const {
  if (!main_.things.empty()) return any_of_names(main_.things);
  const bool is_pronoun = main_.has_any({"it", "that", "them", "this", "one"});
  return is_pronoun && parts_.context.size() == 1 ? *parts_.context.begin() : std::string();
}

void GrammarRules::add_thing(Program& program) const {
  if (const std::string named = thing(); !named.empty()) program.with(FilterKey::kThing, named);
}

void GrammarRules::add_places(Program& program) const {
  if (!main_.places.empty()) program.with(FilterKey::kPlace, any_of_names(main_.places));
}

/// To bring a thing to a place is to place it there; to move one is both to take and to place it;
/// to move without a thing is to drive.
std::optional<std::vector<std::string>> GrammarRules::carrying_skills(
    const ClauseParts& clause, std::string_view lemma) const {
  const auto named = [this](std::initializer_list<std::string_view> verbs) {
    std::vector<std::string> skills;
    for (const std::string_view verb : verbs)
      if (std::string skill = skills_called({verb}); !skill.empty())
        skills.push_back(std::move(skill));
    return skills;
  };
  const bool has_thing = names_thing(clause);
  const bool leads_somewhere = clause.has_any({"to", "onto", "into", "over", "on"});
  const bool is_which = parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich;
  const bool is_taking = is_any(lemma, {"take", "get"});
  if (!has_thing && clause.places.empty()) {
    if (!is_which || is_taking) return {};
    return is_any(lemma, {"move", "shift"}) ? named({"place", "pick"}) : named({"place"});
  }
  // To bring needs a thing, also where the question is which.
  const bool is_of_thing = has_thing || is_any(lemma, {"bring", "carry", "transport", "deliver"});
  if (is_of_thing && !clause.places.empty() && leads_somewhere) return named({"place"});
  if (lemma == "get" && !has_thing && leads_somewhere) return named({"drive"});
  if (is_taking || !has_thing) return {};
  return is_any(lemma, {"bring", "deliver"}) ? named({"place"}) : named({"pick", "place"});
}

std::string GrammarRules::skills_of(const ClauseParts& clause) const {
  std::vector<std::string> skills = clause.skills;
  const auto add = [&](std::string_view lemma) {
    if (std::string named = skills_called({lemma}); !named.empty())
      skills.push_back(std::move(named));
  };
  const auto carry = [&](std::string_view lemma) {
    const auto carrying = carrying_skills(clause, lemma);
    if (carrying) skills.insert(skills.end(), carrying->begin(), carrying->end());
    return carrying.has_value();
  };
  const bool has_thing = names_thing(clause);
  const bool is_which = parts_.asks == Asks::kWhat || parts_.asks == Asks::kWhich;
  for (const TaggedWord* verb : clause.verbs) {
    if (is_carrying(verb->lemma) && carry(verb->lemma)) continue;
    // What takes long is not taken.
    if ((verb->lemma == "take" || verb->lemma == "get") && verb->text != "taking" &&
        clause.verbs.size() > 1 && clause.has_any({"how_long", "long", "longer", "it"}))
      continue;
    // To leave a place is no skill of putting.
    if (verb->lemma == "leave" && !has_thing && clause.has("for") && !clause.places.empty()) {
      add("drive");
      continue;
    }
    if (verb->lemma == "leave" && !has_thing) {
      skills.push_back(verb->lemma);
      continue;
    }
    if (verb->lemma == "take" && clause.has_any({"how_long", "longer", "longest", "shortest"}) &&
        !has_thing)
      continue;
    skills.push_back(skills_or_word(lexicon_, *verb));
  }
  for (const char* lemma : {"bring", "transport", "shift", "relocate", "transfer"})
    if (clause.verbs.empty() && clause.has(lemma)) carry(lemma);
  if (clause.verbs.empty() && clause.has("carry") && (!clause.places.empty() || is_which))
    carry("carry");
  if (clause.verbs.empty() && clause.has("carry") && clause.places.empty() &&
      parts_.asks == Asks::kWhere)
    add(clause.has("from") ? "pick" : "place");
  std::sort(skills.begin(), skills.end());
  skills.erase(std::unique(skills.begin(), skills.end()), skills.end());
  return any_of_names(skills);
}

std::string GrammarRules::skills_called(std::initializer_list<std::string_view> verbs) const {
  std::string skills;
  for (const std::string_view name : verbs) {
    const SkillVerb* verb = verb_with_lemma(name);
    const std::string known = verb == nullptr ? std::string() : lexicon_.skills_of(*verb);
    if (!known.empty()) skills += (skills.empty() ? "" : ",") + known;
  }
  return skills;
}

void GrammarRules::add_skills(Program& program,
                              std::initializer_list<std::string_view> verbs) const {
  if (const std::string skills = skills_called(verbs); !skills.empty())
    program.with(FilterKey::kSkill, skills);
}

Program GrammarRules::executions_of(const ClauseParts& clause) const {
  Program program{ProgramSource::kExecutions, {}, {}};
  if (std::string skills = skills_of(clause); !skills.empty())
    program.with(FilterKey::kSkill, std::move(skills));
  if (!clause.things.empty()) program.with(FilterKey::kThing, any_of_names(clause.things));
  if (!clause.places.empty()) program.with(FilterKey::kPlace, any_of_names(clause.places));
  if (!clause.hands.empty()) program.with(FilterKey::kHand, clause.hands.front());
  return program;
}

Program GrammarRules::executions() const {
  Program program = executions_of(main_);
  if (main_.things.empty()) add_thing(program);
  add_times(program);
  return program;
}

GrammarRules::Found GrammarRules::moment_of_clause() const {
  const SubordinateClause& clause = *parts_.beside;
  const ClauseParts& told = clause.parts;
  Program program{ProgramSource::kExecutions, {}, {}};
  const bool is_said = told.has_any({"say", "ask", "tell", "order", "request", "command", "speak",
                                     "talk", "shout"}) &&
                       (!told.persons.empty() || !told.has_verb() || told.has("i"));
  if (is_said) {
    program.source = ProgramSource::kWords;
    if (!told.persons.empty()) program.with(FilterKey::kSpeaker, told.persons.front());
    if (told.has("stop"))
      program.with(FilterKey::kText, "stop");
    else if (!told.things.empty())
      program.with(FilterKey::kText, told.things.front());
    return program.then(StepKind::kLast).then(StepKind::kWhen);
  }
  program = executions_of(told);
  if (told.has_any({"touch", "handle"}) && program.find(FilterKey::kSkill) == nullptr)
    add_skills(program, {"pick"});
  if (told.things.empty() && told.has_any({"it", "them", "that"}) && !main_.things.empty())
    program.with(FilterKey::kThing, any_of_names(main_.things));
  if (told.has_any({"fail", "unable", "not", "wrong"}))
    program.with(FilterKey::kOutcome, "failure");
  else if (told.has_any({"stop", "interrupt", "halt"}))
    program.with(FilterKey::kOutcome, "stop");
  program.then(told.has("first") ? StepKind::kFirst : StepKind::kLast);
  return program.then(clause.link == ClauseLink::kAfter ? StepKind::kEnded : StepKind::kWhen);
}

void GrammarRules::add_times(Program& program) const {
  const AskedTimes& times = parts_.times;
  if (times.during) program.with(FilterKey::kDuring, *times.during);
  if (times.at) program.with(FilterKey::kAt, *times.at);
  if (times.after) program.with(FilterKey::kAfter, *times.after);
  if (times.before) program.with(FilterKey::kBefore, *times.before);
  if (!parts_.beside || program.source == ProgramSource::kThings ||
      program.source == ProgramSource::kRobot)
    return;
  const FilterKey key = parts_.beside->link == ClauseLink::kAfter    ? FilterKey::kAfter
                        : parts_.beside->link == ClauseLink::kBefore ? FilterKey::kBefore
                                                                     : FilterKey::kAt;
  if (program.find(key) != nullptr) return;
  auto moment = moment_of_clause();
  if (moment)
    program.filters.push_back({key, {{}, std::make_shared<const Program>(*std::move(moment))}});
}

void GrammarRules::add_sight_times(Program& program) const {
  const AskedTimes& times = parts_.times;
  if (times.during) program.with(FilterKey::kDuring, *times.during);
  if (times.after) program.with(FilterKey::kAfter, *times.after);
  if (times.before) program.with(FilterKey::kBefore, *times.before);
  if (!parts_.beside || parts_.beside->link == ClauseLink::kWhile) return;
  const FilterKey key =
      parts_.beside->link == ClauseLink::kAfter ? FilterKey::kAfter : FilterKey::kBefore;
  if (program.find(key) != nullptr) return;
  if (auto moment = moment_of_clause())
    program.filters.push_back({key, {{}, std::make_shared<const Program>(*std::move(moment))}});
}

void GrammarRules::add_moment(Program& program) const {
  const AskedTimes& times = parts_.times;
  if (parts_.beside) {
    auto moment = moment_of_clause();
    if (moment)
      program.filters.push_back(
          {FilterKey::kAt, {{}, std::make_shared<const Program>(*std::move(moment))}});
    return;
  }
  for (const auto* time : {&times.at, &times.during, &times.before, &times.after})
    if (*time) {
      program.with(FilterKey::kAt, **time);
      return;
    }
}

bool GrammarRules::has_order() const {
  return main_.has_any({"first", "last", "latest", "final", "recent", "initial", "earliest",
                        "oldest", "previous", "second", "third", "newest"});
}

void GrammarRules::add_order(Program& program, std::optional<StepKind> otherwise) const {
  if (main_.has_any({"first", "initial", "earliest", "oldest"}))
    program.then(StepKind::kFirst);
  else if (main_.has_any({"last", "latest", "final", "recent", "previous", "newest"}))
    program.then(StepKind::kLast);
  else if (has_text("second"))
    program.then(StepKind::kNth, "2");
  else if (has_text("third"))
    program.then(StepKind::kNth, "3");
  else if (main_.has("longest") || main_.has("slowest"))
    program.then(StepKind::kLongest);
  else if (main_.has_any({"shortest", "quickest", "fastest"}))
    program.then(StepKind::kShortest);
  else if (otherwise)
    program.then(*otherwise);
}

bool GrammarRules::is_of_present() const {
  if (parts_.times.is_now) return true;
  if (!parts_.times.empty() || parts_.beside) return false;
  const bool is_past = main_.has_any({"did", "have", "has", "had", "was", "were", "been"});
  return !is_past && main_.has_any({"are", "is", "do", "current", "currently"});
}

bool GrammarRules::asks_for_hand() const {
  if (main_.hands.size() > 1 && main_.has("or") && parts_.asks != Asks::kWhy) return true;
  for (size_t at = 0; at < main_.words.size(); ++at) {
    const std::string& text = main_.words[at].text;
    if (text != "which" && text != "what" && text != "whichever") continue;
    for (size_t next = at + 1; next < std::min(at + 4, main_.words.size()); ++next) {
      const TaggedWord& word = main_.words[next];
      if (word.lemma == "hand" || word.lemma == "arm" || word.lemma == "gripper") return true;
      if (word.text != "of" && word.text != "your" && word.text != "the") break;
    }
  }
  return parts_.asks == Asks::kNothing && main_.has("hand") &&
         (main_.has_verb() || !main_.things.empty());
}

bool GrammarRules::asks_about_failure() const {
  return main_.has_any({"badly", "amiss", "awry", "fail", "mistake", "error", "problem", "trouble",
                        "issue", "wrong", "difficulty", "mishap", "unable", "mess", "miss",
                        "slip"}) ||
         (main_.has("not") && main_.has_any({"work", "succeed", "manage", "able", "achieve",
                                             "accomplish", "planned", "go"})) ||
         (main_.has("could") && main_.has("not") && !asks_about_stop());
}

bool GrammarRules::asks_about_stop() const {
  return main_.has_any(
             {"quit", "stop", "interrupt", "halt", "abort", "cancel", "pause", "disturb"}) ||
         (main_.has("break") && main_.has("off"));
}

bool GrammarRules::asks_about_sight() const {
  return main_.has_any({"see", "notice", "observe", "perceive", "view", "visible", "sight", "find",
                        "spot", "locate", "watch"});
}

bool GrammarRules::asks_about_words() const {
  return main_.has_any({"hear", "ask", "tell", "say", "speak", "talk", "request", "order",
                        "command", "want", "instruct", "instruction", "demand", "shout", "mention",
                        "call", "utter", "word"});
}

bool GrammarRules::asks_about_holding() const {
  // What a table holds lies on it.
  if (!main_.places.empty() && !is_of_robot() && main_.has("hold") && main_.hands.empty() &&
      main_.has_any({"does", "do", "did"}))
    return false;
  if (main_.has_any({"hold", "carry", "keep"})) return true;
  // "in your right hand"
  for (size_t at = 0; at < main_.words.size(); ++at)
    for (size_t next = at + 1;
         main_.words[at].text == "in" && next < main_.words.size() && next < at + 4; ++next)
      if (main_.words[next].lemma == "hand" || main_.words[next].lemma == "gripper") return true;
  return main_.has("possess");
}

bool GrammarRules::asks_about_attempts() const {
  return main_.has_any({"try", "attempt"});
}

bool GrammarRules::asks_about_success() const {
  return main_.has_any({"succeed", "manage", "accomplish", "achieve", "able"}) ||
         main_.has_words({"get", "done"}) || main_.has_words({"go", "well"}) ||
         main_.has_words({"go", "fine"});
}

GrammarRules::Found GrammarRules::program() {
  using Rule = Found (GrammarRules::*)();
  for (const Rule rule :
       {&GrammarRules::planned, &GrammarRules::same_hand, &GrammarRules::where_when_seen})
    if (Found found = (this->*rule)()) return says_all(*found) ? found : Found();
  if (is_beyond_programs()) return {};
  constexpr Rule kRules[] = {
      &GrammarRules::instead,  &GrammarRules::unfinished, &GrammarRules::who,
      &GrammarRules::why,      &GrammarRules::when,       &GrammarRules::amounts,
      &GrammarRules::coloured, &GrammarRules::which,      &GrammarRules::where,
      &GrammarRules::holding,  &GrammarRules::compared,   &GrammarRules::whether,
      &GrammarRules::what};
  for (const Rule rule : kRules)
    if (Found found = (this->*rule)()) return says_all(*found) ? found : Found();
  return {};
}

}  // namespace engram::speech
