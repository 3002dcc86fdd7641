// SPDX-License-Identifier: Apache-2.0
#include "speech/language/question_parts.h"

#include <algorithm>

#include "speech/language/english.h"

namespace engram::speech {

namespace {

using TaggedWords = std::vector<TaggedWord>;

bool is_word(const TaggedWord& word, std::initializer_list<std::string_view> texts) {
  return is_any(word.text, texts);
}

/// What a word asks for where it is a question word.
Asks asked_by(const TaggedWords& words, size_t at) {
  const TaggedWord& word = words[at];
  if (is_word(word, {"where"})) return Asks::kWhere;
  if (is_word(word, {"when"})) return Asks::kWhen;
  if (is_word(word, {"who", "whom", "whose"})) return Asks::kWho;
  if (is_word(word, {"why"})) return Asks::kWhy;
  if (is_word(word, {"how_long"})) return Asks::kHowLong;
  if (is_word(word, {"how_far"})) return Asks::kHowFar;
  if (is_word(word, {"how_often"})) return Asks::kHowOften;
  if (is_word(word, {"how_ago"})) return Asks::kHowAgo;
  if (is_word(word, {"which"})) return Asks::kWhich;
  if (is_word(word, {"what"})) return Asks::kWhat;
  if (is_word(word, {"whatever"}) && at == 0) return Asks::kWhat;
  if (is_word(word, {"how"}))
    return at + 1 < words.size() && is_word(words[at + 1], {"many", "much"}) ? Asks::kHowMany
                                                                             : Asks::kHow;
  return Asks::kNothing;
}

/// A marker that a subordinate clause may begin with.
std::optional<ClauseLink> link_of(const TaggedWord& word) {
  if (is_word(word, {"after", "once", "since"})) return ClauseLink::kAfter;
  if (is_word(word, {"before", "until", "till"})) return ClauseLink::kBefore;
  if (is_word(word, {"while", "during", "when", "whilst"})) return ClauseLink::kWhile;
  return {};
}

/// Where the clause that begins at a marker ends: at a comma, or where a question word or an
/// auxiliary begins the main clause.
size_t end_of_clause(const TaggedWords& words, size_t begin) {
  for (size_t at = begin; at < words.size(); ++at) {
    if (words[at].ends_clause) return at + 1;
    // "when you could not lift the salt did you repeat it": whoever leaves out the comma.
    if (begin == 1 && at > begin + 1 && is_auxiliary(words[at].text) && at + 1 < words.size() &&
        is_word(words[at + 1], {"you", "it", "the", "there"}) &&
        !is_word(words[at - 1], {"you", "that", "which"}))
      return at;
    if (at > begin + 1 && asked_by(words, at) != Asks::kNothing && !is_word(words[at], {"when"}))
      return at;
  }
  return words.size();
}

/// Whether a clause says nothing but that it asks of another one: "what was it", "when was that",
/// "how long did it take".
bool asks_of_other(const TaggedWords& words) {
  bool is_asking = false;
  for (const TaggedWord& word : words) {
    const Asks asks = asked_by(words, static_cast<size_t>(&word - words.data()));
    const bool is_little =
        asks != Asks::kNothing || word.tag == WordTag::kFiller || word.tag == WordTag::kUnknown ||
        is_word(word,
                {"it",    "that",   "this",     "them",     "those",      "these",    "one",
                 "ones",  "so",     "first",    "last",     "then",       "of",       "all",
                 "both",  "he",     "she",      "they",     "exactly",    "many",     "much",
                 "times", "long",   "for",      "from",     "and",        "not",      "called",
                 "name",  "number", "in",       "total",    "altogether", "just",     "was",
                 "did",   "is",     "take",     "took",     "again",      "who",      "what",
                 "which", "once",   "twice",    "tries",    "by",         "attempts", "attempt",
                 "with",  "whom",   "duration", "distance", "need",       "needed"}) ||
        word.lemma == "be" || word.lemma == "do" || word.lemma == "have";
    const bool is_of_robot = is_word(word, {"you", "robot", "something", "anything", "nothing"});
    is_asking = is_asking ||
                asked_by(words, static_cast<size_t>(&word - words.data())) != Asks::kNothing ||
                is_word(word, {"did", "was", "whether"});
    if (!is_little || (is_of_robot && &word != &words.back())) return false;
  }
  return is_asking;
}

bool has_event(const TaggedWords& words, size_t begin, size_t end) {
  for (size_t at = begin; at < end; ++at) {
    const TaggedWord& word = words[at];
    if (word.tag == WordTag::kVerb || word.tag == WordTag::kSkill) return true;
    if (word.tag == WordTag::kGrammar &&
        is_any(word.lemma, {"fail", "stop", "interrupt", "say", "ask", "tell", "bring", "move",
                            "carry", "touch", "handle", "speak", "talk", "shout"}))
      return true;
  }
  return false;
}

/// Takes a subordinate clause out of a sentence.
std::optional<SubordinateClause> take_clause(TaggedWords& words) {
  for (size_t at = 0; at < words.size(); ++at) {
    const auto link = link_of(words[at]);
    if (!link) continue;
    const bool is_when = is_word(words[at], {"when"});
    const size_t end = end_of_clause(words, at + 1);
    // "When did you ..." asks, and so does "when you ..." where nothing else does.
    if (is_when && at + 1 < words.size() && is_auxiliary(words[at + 1].text)) continue;
    if (is_when && at == 0 && end == words.size()) continue;
    if (is_when && at > 0 && is_word(words[at - 1], {"and", "or"})) continue;
    if (!has_event(words, at + 1, end)) continue;
    SubordinateClause clause{*link, words[at].text == "since",
                             ClauseParts(TaggedWords(words.begin() + static_cast<ptrdiff_t>(at) + 1,
                                                     words.begin() + static_cast<ptrdiff_t>(end)))};
    TaggedWords rest(words.begin(), words.begin() + static_cast<ptrdiff_t>(at));
    rest.insert(rest.end(), words.begin() + static_cast<ptrdiff_t>(end), words.end());
    words = std::move(rest);
    return clause;
  }
  return {};
}

/// A word that tells of an event or of what it is about.
bool is_of_clause(const TaggedWord& word) {
  return word.tag == WordTag::kThing || word.tag == WordTag::kPlace ||
         word.tag == WordTag::kSkill ||
         (word.tag == WordTag::kVerb && word.lemma != "take" && word.lemma != "need");
}

bool has_word(const TaggedWords& words, std::initializer_list<std::string_view> texts) {
  return std::any_of(words.begin(), words.end(),
                     [&](const TaggedWord& word) { return is_word(word, texts); });
}

bool has_tag(const TaggedWords& words, std::initializer_list<WordTag> tags) {
  return std::any_of(words.begin(), words.end(), [&](const TaggedWord& word) {
    return std::find(tags.begin(), tags.end(), word.tag) != tags.end();
  });
}

/// What a question word asks for that stands behind an auxiliary, which `begin` is: kNothing where
/// there is none.
Asks asked_behind_auxiliary(const TaggedWords& words, size_t begin) {
  const bool is_had = is_word(words[begin], {"had"});
  // "Did somebody give you tasks, and who was it?"
  if (!is_had)
    for (size_t at = begin + 2; at < words.size(); ++at)
      if ((words[at - 1].ends_clause || is_word(words[at - 1], {"and"})) &&
          asked_by(words, at) != Asks::kNothing && asked_by(words, at) != Asks::kWhen)
        return asked_by(words, at);
  // "Did you do anything, and what?"
  const Asks at_end = asked_by(words, words.size() - 1);
  if (words.size() > begin + 3 && at_end != Asks::kNothing && at_end != Asks::kWhen) return at_end;
  // "Had you picked it up, what would ..."
  if (is_had)
    for (size_t at = begin + 1; at < words.size(); ++at)
      if (words[at - 1].ends_clause && asked_by(words, at) != Asks::kNothing)
        return asked_by(words, at);
  return Asks::kNothing;
}

/// What the first question word asks for; kNothing where there is none.
Asks asked_by_word(const TaggedWords& words) {
  Asks found = Asks::kNothing;
  for (size_t at = 0; at < words.size() && found == Asks::kNothing; ++at)
    found = asked_by(words, at);
  // "How long was that, in metres?"
  if (found == Asks::kHowLong && has_word(words, {"how_far"})) return Asks::kHowFar;
  // For whom and why: the reasons tell both.
  if (found == Asks::kWho)
    for (size_t at = 1; at + 1 < words.size(); ++at)
      if (is_word(words[at], {"and"}) && asked_by(words, at + 1) == Asks::kWhy) return Asks::kWhy;
  return found;
}

/// What a clause asks for by naming it: "Objects placed?", "The salt on the table?"
Asks asked_by_names(const TaggedWords& words) {
  const bool has_thing_word =
      has_word(words, {"objects", "things", "items", "object", "item", "thing"});
  const bool has_deed = std::any_of(words.begin(), words.end(), [](const TaggedWord& word) {
    return word.tag == WordTag::kVerb || is_any(word.lemma, {"see", "hold"}) ||
           word.text == "visible";
  });
  const bool has_place = has_tag(words, {WordTag::kPlace});
  if (std::any_of(words.begin(), words.end(),
                  [](const TaggedWord& word) { return is_auxiliary(word.text); }))
    return Asks::kNothing;
  // "Last command received?"
  if (has_word(words, {"command", "order", "request", "instruction", "task"}) &&
      has_word(words, {"first", "last", "latest"}))
    return Asks::kWhat;
  const bool is_plural = has_word(words, {"objects", "things", "items"});
  const bool is_counted = has_word(words, {"count", "number", "altogether", "with"});
  if (has_thing_word && !is_counted && (has_deed || (has_place && is_plural))) return Asks::kWhich;
  // "An object on the counter?"
  const bool has_thing =
      has_thing_word || has_tag(words, {WordTag::kThing}) || has_word(words, {"anything"});
  return has_thing && has_place && !has_deed ? Asks::kWhether : Asks::kNothing;
}

/// Whether a clause without a question word asks whether something is so.
bool asks_whether(const TaggedWords& words, bool is_indirect) {
  // "Is it true that you picked up the salt?", "Do you remember picking up the salt?"
  if (is_indirect && words.front().text == "you") return true;
  if (is_indirect && words.front().text.ends_with("ing") &&
      (words.front().tag == WordTag::kVerb || words.front().lemma == "see"))
    return true;
  for (size_t at = 0; at < words.size(); ++at)
    if (is_auxiliary(words[at].text) && (words[at].begins_sentence || at < 4)) return true;
  // "You picked up the salt?"
  return has_word(words, {"you"}) && has_tag(words, {WordTag::kVerb, WordTag::kSkill});
}

/// What a clause asks for; a question word that asks more than that something is comes first.
Asks asked_for(const TaggedWords& words, bool is_indirect) {
  // "Was it the right hand with which you ..." asks whether.
  const size_t begin = begin_of_asking(words);
  if (is_word(words[begin], {"whether"})) return Asks::kWhether;
  const bool is_first = is_auxiliary(words[begin].text);
  if (is_first)
    if (const Asks behind = asked_behind_auxiliary(words, begin); behind != Asks::kNothing)
      return behind;
  if (!is_indirect && is_first) return Asks::kWhether;
  // "Any problems today?"
  if (!is_indirect && is_word(words[begin], {"any", "anything", "ever"}) &&
      !has_word(words, {"where", "what", "which", "who", "why", "how", "when"}))
    return Asks::kWhether;
  // "Did you see where ..." asks where; "did you do what ..." is rare.
  if (const Asks found = asked_by_word(words); found != Asks::kNothing) return found;
  if (is_indirect && has_word(words, {"if", "whether"})) return Asks::kWhether;
  // "Everything you did", "whatever you put down".
  if (has_word(words, {"everything", "whatever", "every", "all"}) && !is_first) return Asks::kWhat;
  if (const Asks found = asked_by_names(words); found != Asks::kNothing) return found;
  return asks_whether(words, is_indirect) ? Asks::kWhether : Asks::kNothing;
}

/// Whether a main clause asks of the very event that its subordinate clause tells of: "Why were you
/// stopped while picking up the tea?", and not where the robot was or what it did then.
bool asks_of_clause(const TaggedWords& main, Asks asks) {
  if (asks_of_other(main)) return true;
  if (std::any_of(main.begin(), main.end(), is_of_clause)) return false;
  const auto has = [&](std::initializer_list<std::string_view> lemmas) {
    return std::any_of(main.begin(), main.end(),
                       [&](const TaggedWord& word) { return is_any(word.lemma, lemmas); });
  };
  if (asks == Asks::kWhy || asks == Asks::kHowLong || asks == Asks::kHowFar) return true;
  if (has({"hold", "carry", "see", "be"}) && asks == Asks::kWhere) return false;
  if (asks == Asks::kWhat && has({"happen"})) return true;
  return has({"hand", "arm", "gripper", "distance", "duration", "fail", "trouble", "problem",
              "difficulty", "wrong", "mistake", "miss"});
}

std::vector<TaggedWords> sentences_of(const TaggedWords& words) {
  std::vector<TaggedWords> sentences;
  for (const TaggedWord& word : words) {
    if (word.begins_sentence || sentences.empty()) sentences.emplace_back();
    sentences.back().push_back(word);
  }
  return sentences;
}

/// The sentence that asks: the last one with a question word, else the last that begins as
/// questions do, else the last.
size_t asking_sentence(const std::vector<TaggedWords>& sentences) {
  const auto begins_asking = [](const TaggedWords& words) {
    for (size_t at = 0; at < std::min<size_t>(2, words.size()); ++at)
      if (is_auxiliary(words[at].text) || asked_by(words, at) != Asks::kNothing) return true;
    // "The salt, I mean, where is it?"
    for (size_t at = 2; at + 1 < words.size(); ++at)
      if (words[at - 1].ends_clause && asked_by(words, at) != Asks::kNothing &&
          is_auxiliary(words[at + 1].text))
        return true;
    return false;
  };
  for (size_t i = sentences.size(); i-- > 0;)
    if (begins_asking(sentences[i])) return i;
  for (size_t i = sentences.size(); i-- > 0;)
    for (size_t at = 0; at < sentences[i].size(); ++at)
      if (asked_by(sentences[i], at) != Asks::kNothing) return i;
  // "The salt, please. Thanks." Whatever has most names.
  size_t best = sentences.size() - 1;
  size_t max_names = 0;
  for (size_t i = sentences.size(); i-- > 0;) {
    const auto names = static_cast<size_t>(
        std::count_if(sentences[i].begin(), sentences[i].end(), [](const TaggedWord& word) {
          return word.tag != WordTag::kFiller && word.tag != WordTag::kUnknown;
        }));
    if (names <= max_names) continue;
    max_names = names;
    best = i;
  }
  return best;
}

}  // namespace

size_t begin_of_asking(const std::vector<TaggedWord>& words) {
  size_t begin = 0;
  while (begin + 1 < words.size() &&
         is_word(words[begin], {"so", "and", "well", "but", "ok", "okay", "hey", "hello", "hi",
                                "robot", "please", "then", "now", "um", "oh"}))
    ++begin;
  return begin;
}

ClauseParts::ClauseParts(std::vector<TaggedWord> of) : words(std::move(of)) {
  const auto add_once = [](std::vector<std::string>& list, const std::string& value) {
    if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
  };
  for (const TaggedWord& word : words) {
    switch (word.tag) {
      case WordTag::kThing:
        add_once(things, word.value);
        break;
      case WordTag::kPlace:
        add_once(places, word.value);
        break;
      case WordTag::kPerson:
        add_once(persons, word.value);
        break;
      case WordTag::kHand:
        add_once(hands, word.value);
        break;
      case WordTag::kSkill:
        add_once(skills, word.value);
        break;
      case WordTag::kVerb:
        verbs.push_back(&word);
        lemmas.insert(word.lemma);
        break;
      case WordTag::kUnknown:
        break;
      default:
        lemmas.insert(word.lemma);
        lemmas.insert(word.text);
        break;
    }
  }
}

bool ClauseParts::has_any(std::initializer_list<std::string_view> any) const {
  return std::any_of(any.begin(), any.end(), [this](std::string_view one) { return has(one); });
}

bool ClauseParts::has_words(std::initializer_list<std::string_view> row) const {
  for (size_t at = 0; at + row.size() <= words.size(); ++at) {
    size_t same = 0;
    for (const std::string_view text : row) {
      const TaggedWord& word = words[at + same];
      if (word.text != text && word.lemma != text) break;
      ++same;
    }
    if (same == row.size()) return true;
  }
  return false;
}

QuestionParts parts_of_question(const std::vector<TaggedWord>& words, AskedTimes times,
                                bool is_indirect) {
  std::vector<TaggedWords> sentences = sentences_of(words);
  const size_t asking = asking_sentence(sentences);
  TaggedWords main = sentences[asking];
  // "You were at the table. Why?" asks of the sentence before.
  size_t told = asking;
  std::optional<Asks> asked;
  const auto is_of_asker = [](const TaggedWord& word) { return is_word(word, {"i", "we"}); };
  if (asking > 0 && (asks_of_other(main) || main.size() == 1) &&
      !is_of_asker(sentences[asking - 1].front())) {
    asked = asked_for(main, is_indirect);
    told = asking - 1;
    main.insert(main.begin(), sentences[told].begin(), sentences[told].end());
  }
  // "The table had things on it. What did you take from there?"
  const bool has_place_word = has_tag(main, {WordTag::kPlace});
  const bool is_of_there = has_word(main, {"there", "it", "one"});
  const bool has_thing_name = has_tag(main, {WordTag::kThing});
  if (asking > 0 && !has_place_word && is_of_there)
    for (const TaggedWord& word : sentences[asking - 1])
      if (word.tag == WordTag::kPlace && (!has_thing_name || has_word(main, {"there"}))) {
        main.push_back(word);
        main.back().begins_sentence = false;
        break;
      }
  auto beside = take_clause(main);
  const Asks asks = main.empty() ? Asks::kNothing : asked ? *asked : asked_for(main, is_indirect);
  const auto has_same_verb = [&] {
    return std::any_of(main.begin(), main.end(), [&](const TaggedWord& word) {
      const auto& verbs = beside->parts.verbs;
      return word.verb != nullptr &&
             std::any_of(verbs.begin(), verbs.end(),
                         [&](const TaggedWord* verb) { return verb->verb == word.verb; });
    });
  };
  // "How far did you drive when you went to the table?" asks of one drive.
  const bool is_of_amount = asks == Asks::kHowFar || asks == Asks::kHowLong;
  if (beside && beside->link == ClauseLink::kWhile &&
      (asks_of_clause(main, asks) || (is_of_amount && has_same_verb()))) {
    main.insert(main.end(), beside->parts.words.begin(), beside->parts.words.end());
    beside.reset();
  }
  QuestionParts parts(asks, ClauseParts(std::move(main)));
  if (beside) parts.beside.emplace(std::move(*beside));
  parts.times = std::move(times);
  for (size_t i = 0; i < sentences.size(); ++i)
    if (i != asking) parts.told.insert(parts.told.end(), sentences[i].begin(), sentences[i].end());
  for (size_t i = 0; i < sentences.size(); ++i)
    if (i != asking && i != told)
      for (const TaggedWord& word : sentences[i])
        (word.tag == WordTag::kThing ? parts.context : parts.context_lemmas)
            .insert(word.tag == WordTag::kThing ? word.value : word.lemma);
  return parts;
}

}  // namespace engram::speech
