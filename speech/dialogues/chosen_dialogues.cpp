// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/chosen_dialogues.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "speech/dialogues/asking_times.h"
#include "speech/dialogues/careless.h"
#include "speech/dialogues/random_choice.h"

namespace engram::speech::dialogues {

namespace {

/// Chooses one of all questions after the other, families in turn.
class Chooser {
 public:
  Chooser(const std::deque<KnownAnswer>& known, uint64_t seed) : random_(seed) {
    for (const KnownAnswer& one : known) {
      std::vector<WordedQuestion> words = worded(one);
      // A form without words cannot be asked.
      if (words.empty()) continue;
      words_.emplace(&one, std::move(words));
      by_family_[one.family][form_of(one.asked)][tells_of_nothing(one)][one.now].push_back(&one);
    }
  }

  /// Null: no question is left in this family.
  const KnownAnswer* choose(const std::string& family) {
    const auto found = by_family_.find(family);
    if (found == by_family_.end()) return nullptr;
    const Alike& alike = one_of(found->second, random_)->second;
    const auto& by_time = one_of(alike, random_)->second;
    return *one_of(one_of(by_time, random_)->second, random_);
  }

  /// All ways to put a question that was chosen.
  const std::vector<WordedQuestion>& words_of(const KnownAnswer& known) const {
    return words_.at(&known);
  }
  std::mt19937_64& random() { return random_; }

 private:
  std::mt19937_64 random_;
  std::map<std::string, std::map<std::string, Alike>> by_family_;
  std::map<const KnownAnswer*, std::vector<WordedQuestion>> words_;
};

}  // namespace

bool tells_of_nothing(const KnownAnswer& known) {
  const AnswerValue& value = known.value;
  return value == AnswerValue(answers::YesNo{false}) || value == AnswerValue(answers::Count{0}) ||
         value == AnswerValue(answers::Names{}) || value == AnswerValue(answers::Events{});
}

std::vector<std::string> plain_words(const KnownAnswer& known) {
  constexpr size_t kCount = 3;
  std::vector<std::string> plain;
  const std::vector<WordedQuestion> all = worded(known);
  // Some of different templates: those of one stand side by side.
  const size_t step = std::max<size_t>(1, all.size() / kCount);
  for (size_t i = 0; i < all.size() && plain.size() < kCount; i += step)
    plain.push_back(all[i].text);
  return plain;
}

Result<LivedPast> read_past(Memory& memory, const DialogueOptions& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(LivedPast past, LivedPast::read(memory));
  const Time begin = past.recordings.front().first;
  if (options.now && *options.now < begin)
    return invalid_argument("dialogues: now is {}, needs {} or later, when a recording begins",
                            to_string(*options.now), to_string(begin));
  return past;
}

bool is_in(DialogueSplit split, const Dialogue& dialogue) {
  return split == DialogueSplit::kAll ||
         (split == DialogueSplit::kTrain) == dialogue.held_out.empty();
}

Dialogue dialogue_of(const LivedPast& past, const KnownAnswer& known, const WordedQuestion& words) {
  Dialogue dialogue{.family = known.family,
                    .form = form_of(known.asked),
                    .question = words.text,
                    .phrasing = words.phrasing,
                    .seed = past.seed,
                    .now = known.now,
                    .value = known.value,
                    .also = known.also,
                    .evidence = known.evidence};
  if (is_phrasing_held_out(words.phrasing)) dialogue.held_out.emplace_back("phrasing");
  if (is_seed_held_out(past.seed)) dialogue.held_out.emplace_back("seed");
  const auto is_held_out = [](const std::string& thing) {
    return !thing.empty() && is_thing_held_out(thing);
  };
  const auto in_slot = [&](const char* name) {
    const auto slot = known.slots.find(name);
    return slot == known.slots.end() ? std::string() : slot->second;
  };
  if (is_held_out(known.asked.thing) || is_held_out(in_slot("thing2")) ||
      is_held_out(in_slot("known")))
    dialogue.held_out.emplace_back("thing");
  return dialogue;
}

std::deque<KnownAnswer> all_known(const LivedPast& past, const DialogueOptions& options) {
  if (options.now) return known_answers(past.until(*options.now), *options.now, options.seed);
  const Time last = past.last_moment();
  std::deque<KnownAnswer> known = known_answers(past, last, options.seed);
  uint64_t seed = options.seed;
  for (const Time now : asking_times(past, options.seed))
    for (KnownAnswer& one : known_answers(past.until(now), now, ++seed))
      known.push_back(std::move(one));
  const Time next_day = day_of(last) + std::chrono::hours(24 + 9);
  for (KnownAnswer& one : known_answers(past, next_day, options.seed + 1)) {
    // The rest is the same on every day.
    if (one.asked.when != "all" && one.asked.when != "now") known.push_back(std::move(one));
  }
  return known;
}

std::vector<Dialogue> chosen_dialogues(const LivedPast& past, const DialogueOptions& options) {
  constexpr size_t kTriesForEach = 60;
  constexpr size_t kCount = 50;
  const size_t count = options.count.value_or(kCount);
  const std::deque<KnownAnswer> known = all_known(past, options);
  Chooser chooser(known, options.seed);
  std::vector<Dialogue> made;
  std::set<std::pair<std::string, Time>> asked;
  for (size_t i = 0; i < kTriesForEach * count && made.size() < count; ++i) {
    const KnownAnswer* one = chooser.choose(kFamilies[made.size() % std::size(kFamilies)]);
    // A family that has nothing more to ask gives its turn to another one.
    if (one == nullptr || i % kTriesForEach == kTriesForEach - 1)
      one = chooser.choose(kFamilies[below(std::size(kFamilies), chooser.random())]);
    if (one == nullptr) continue;
    const WordedQuestion& words = *one_of(chooser.words_of(*one), chooser.random());
    if (!asked.emplace(words.text, one->now).second) continue;
    Dialogue dialogue = dialogue_of(past, *one, words);
    if (!is_in(options.split, dialogue)) continue;
    put_carelessly(dialogue, *one, options.careless, chooser.random());
    dialogue.id = fmt::format("{}-{}", past.seed, made.size());
    if (options.tells_plainly) dialogue.plain = plain_words(*one);
    made.push_back(std::move(dialogue));
  }
  return made;
}

}  // namespace engram::speech::dialogues
