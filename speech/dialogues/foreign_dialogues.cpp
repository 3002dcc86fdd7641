// SPDX-License-Identifier: Apache-2.0
// Questions in the words of others: each is filled once with something that it fits.
#include <algorithm>
#include <map>
#include <random>

#include "speech/dialogues/careless.h"
#include "speech/dialogues/chosen_dialogues.h"
#include "speech/dialogues/foreign_phrasings.h"
#include "speech/dialogues/random_choice.h"

namespace engram::speech {

namespace dialogues {

namespace {

/// What fills the words of questions that say themselves that they cannot be answered: any thing,
/// place and time.
std::deque<KnownAnswer> fillings_of_unknown(const LivedPast& past,
                                            const std::deque<KnownAnswer>& known) {
  std::deque<KnownAnswer> fillings;
  for (const KnownAnswer& one : known) {
    if (!one.slots.contains("time") && !one.slots.contains("ago")) continue;
    for (const auto& [thing, sights] : past.sights) {
      KnownAnswer filling{.family = "unanswerable",
                          .asked = {.what = "unanswerable:foreign", .thing = thing},
                          .slots = one.slots,
                          .now = one.now};
      filling.asked.place = past.places.empty() ? "" : past.places.begin()->first;
      filling.slots["thing2"] = past.sights.begin()->first;
      fillings.push_back(std::move(filling));
    }
  }
  return fillings;
}

/// The names of the things that were in sight.
std::vector<std::string> seen_things(const LivedPast& past) {
  std::vector<std::string> seen;
  for (const auto& [thing, sights] : past.sights)
    if (std::any_of(sights.begin(), sights.end(),
                    [](const LivedSight& one) { return one.is_visible; }))
      seen.push_back(thing);
  return seen;
}

class ForeignMaker {
 public:
  ForeignMaker(const LivedPast& past, const DialogueOptions& options)
      : past_(past),
        options_(options),
        known_(all_known(past, options)),
        unknown_(fillings_of_unknown(past, known_)),
        seen_(seen_things(past)),
        random_(options.seed) {
    for (const KnownAnswer& one : known_) by_form_[form_of(one.asked)].push_back(&one);
  }

  /// Nothing: the recordings have nothing that the words fit.
  std::optional<Dialogue> make(const ForeignPhrasing& phrasing) {
    Alike alike;
    for (const KnownAnswer* one : fitting(phrasing))
      alike[tells_of_nothing(*one)][one->now].push_back(one);
    while (!alike.empty()) {
      const auto sort = one_of(alike, random_);
      const auto at_time = one_of(sort->second, random_);
      std::vector<const KnownAnswer*>& all = at_time->second;
      std::swap(*one_of(all, random_), all.back());
      auto made = filled(phrasing, *all.back());
      if (made) return made;
      all.pop_back();
      if (all.empty()) sort->second.erase(at_time);
      if (sort->second.empty()) alike.erase(sort);
    }
    return {};
  }

  std::mt19937_64& random() { return random_; }

 private:
  std::vector<const KnownAnswer*> fitting(const ForeignPhrasing& phrasing) const {
    std::vector<const KnownAnswer*> all;
    if (!phrasing.form.empty()) {
      const auto of_form = by_form_.find(phrasing.form);
      if (of_form == by_form_.end()) return all;
      for (const KnownAnswer* one : of_form->second)
        if (fits(phrasing, *one)) all.push_back(one);
      return all;
    }
    for (const KnownAnswer& one : phrasing.is_unanswerable() ? unknown_ : known_)
      if (fits(phrasing, one)) all.push_back(&one);
    return all;
  }

  /// The words filled with what is asked, in one way of several; nothing if there is none in the
  /// split that is wanted.
  std::optional<Dialogue> filled(const ForeignPhrasing& phrasing, KnownAnswer known) {
    if (!seen_.empty() && phrasing.question.find("{known}") != std::string::npos)
      known.slots["known"] = *one_of(seen_, random_);
    std::vector<Dialogue> ways;
    for (const WordedQuestion& words : worded_with(phrasing, known)) {
      Dialogue one = dialogue_of(past_, known, words);
      // Who wrote them knew nothing of the own words.
      if (phrasing.form.empty()) one.held_out = {"phrasing"};
      if (is_in(options_.split, one)) ways.push_back(std::move(one));
    }
    if (ways.empty()) return {};
    Dialogue chosen = std::move(*one_of(ways, random_));
    put_carelessly(chosen, known, options_.careless, random_);
    if (options_.tells_plainly) chosen.plain = plain_words(known);
    return chosen;
  }

  const LivedPast& past_;
  const DialogueOptions& options_;
  std::deque<KnownAnswer> known_;
  std::deque<KnownAnswer> unknown_;
  std::vector<std::string> seen_;
  std::map<std::string, std::vector<const KnownAnswer*>> by_form_;
  std::mt19937_64 random_;
};

std::vector<Dialogue> foreign_dialogues(const LivedPast& past, const DialogueOptions& options,
                                        const std::vector<ForeignPhrasing>& phrasings) {
  ForeignMaker maker(past, options);
  std::vector<Dialogue> made;
  for (const ForeignPhrasing& phrasing : phrasings)
    if (auto one = maker.make(phrasing)) made.push_back(*std::move(one));
  // A random part of them, where fewer are wanted.
  if (options.count && made.size() > *options.count) {
    for (size_t i = made.size(); i > 1; --i) std::swap(made[i - 1], made[below(i, maker.random())]);
    made.resize(*options.count);
  }
  for (size_t i = 0; i < made.size(); ++i) made[i].id = fmt::format("{}-f{}", past.seed, i);
  return made;
}

}  // namespace

}  // namespace dialogues

Result<std::vector<Dialogue>> make_dialogues_with(Memory& memory, const DialogueOptions& options,
                                                  const std::filesystem::path& phrasings) {
  ENGRAM_ASSIGN_OR_RETURN(const auto read, dialogues::read_phrasings(phrasings));
  ENGRAM_ASSIGN_OR_RETURN(const dialogues::LivedPast past, dialogues::read_past(memory, options));
  return dialogues::foreign_dialogues(past, options, read);
}

Result<std::vector<Dialogue>> make_written_dialogues(Memory& memory,
                                                     const DialogueOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const dialogues::LivedPast past, dialogues::read_past(memory, options));
  const auto& read = dialogues::written_phrasings();
  ENGRAM_RETURN_IF_ERROR(read.status());
  return dialogues::foreign_dialogues(past, options, *read);
}

}  // namespace engram::speech
