// SPDX-License-Identifier: Apache-2.0
// Base forms of verbs and nouns.
#include <map>

#include "speech/language/word_pattern.h"
#include "speech/language/words.h"

namespace engram::speech {

namespace {

/// A base form, and the forms of it that no ending makes, or that mean the same.
constexpr std::pair<std::string_view, std::string_view> kForms[] = {
    {"colour", "colours color colors coloured colored hue tint"},
    {"look", "rummage rummaged rummaging sought examined explored"},
    {"take", "took taken"},
    {"get", "got gotten getting"},
    {"drive",
     "drove driven trip trips journey journeys trundled trundle trundling navigation motion "
     "movement roam roamed proceeded cruised journeyed betake betaken"},
    {"go", "went gone goes going"},
    {"see",
     "saw seen seeing behold beheld spy spied spying detect detected detects detecting detection "
     "glimpse glimpsed sighting sightings observation observable observed perceived witnessed "
     "recognised recognized sighted encountered captured registered noticed viewed"},
    {"hold", "held"},
    {"bring", "brought delivery"},
    {"say", "said saying"},
    {"tell", "told"},
    {"speak", "spoke spoken"},
    {"come", "came"},
    {"find", "found"},
    {"give", "gave given"},
    {"begin", "began begun"},
    {"do", "did done doing does"},
    {"make", "made"},
    {"keep", "kept"},
    {"fall", "fell fallen"},
    {"break", "broke broken"},
    {"want", "wanted"},
    {"stand", "stood"},
    {"lose", "lost"},
    {"have", "had has having"},
    {"be", "was were is are been being am"},
    {"try", "tried tries"},
    {"retry", "retried"},
    {"carry", "carried carries"},
    {"stop", "stopped stopping stoppage ceased cease ceasing stops terminated suspended curtailed"},
    {"put", "putting stashed stick plonk plonked plop plopped stash stashing stow stowed unloaded"},
    {"set", "setting"},
    {"grab",
     "grabbed grabbing snatch snatched snatching pluck plucked plucking clutch clutched clutching "
     "retrieve retrieved retrieving hoist hoisted scoop scooped obtained"},
    {"drop", "dropped dropping"},
    {"grip", "gripped"},
    {"spot", "spotted"},
    {"lay", "laid"},
    {"leave", "leaving"},
    {"run", "ran running"},
    {"forget", "forgot forgotten"},
    {"thing", "things"},
    {"object", "objects"},
    {"happen", "happened happening"},
    {"work", "worked working"},
    {"need", "needed"},
    {"ask", "asked"},
    {"time", "times"},
    {"fail",
     "failure failures unsuccessful unsuccessfully bungle bungled bungling botch botched flopped "
     "fumble fumbled fluffed mishandled malfunctioned setback setbacks blunder blundered flop"},
    {"succeed", "success successful successfully successes"},
    {"pick", "picking picks"},
    {"move", "moved displaced displacement"},
    {"manage", "managed"},
    {"lie", "lying"},
    {"sit", "sat"},
    {"use", "used using"},
    {"place", "placed placing placement placements"},
    {"lift", "lifted"},
    {"think", "thought"},
    {"know", "knew"},
    {"interrupt", "interrupted interruption interruptions"},
    {"achieve", "achieved"},
    {"quit", "quitting"},
    {"hear", "heard"},
    {"endure", "lasted"},
    {"grasp", "grasped grasps"},
    {"error", "errors"},
    {"remove", "removed removing"},
    {"hunt", "hunted hunting hunts"},
    {"show", "shown"},
    {"catch", "caught"},
    {"achievement", "achievements"},
    {"receive", "receiving received"},
    {"halt", "halted"},
    {"send", "sent"},
    {"spend", "spent"},
    {"buy", "bought"},
    {"search", "searches"},
    {"occur", "occurred occurring"},
    {"end", "ended"},
    {"handle", "fiddled fiddling fiddle attending attended"},
    {"deal", "dealings"},
};

/// What looks like a form and is none: "this" is no plural.
constexpr std::string_view kBaseForms =
    "left stuck wrong this his grasp lay during nothing something anything everything morning "
    "evening always perhaps yes us as bring thing red need bed speed hundred indeed less across "
    "else glass";

const std::map<std::string_view, std::string_view>& irregular_forms() {
  static const std::map<std::string_view, std::string_view> kAll = [] {
    std::map<std::string_view, std::string_view> all;
    for (const auto& [lemma, forms] : kForms)
      for (const std::string_view form : parts_between(forms, ' ')) all.emplace(form, lemma);
    for (const std::string_view form : parts_between(kBaseForms, ' ')) all.emplace(form, form);
    return all;
  }();
  return kAll;
}

}  // namespace

std::vector<std::string> irregular_words() {
  std::vector<std::string> words;
  for (const auto& [word, lemma] : irregular_forms()) words.emplace_back(word);
  return words;
}

std::string lemma_of(const std::string& word) {
  const auto& forms = irregular_forms();
  if (const auto found = forms.find(word); found != forms.end()) return std::string(found->second);
  const auto without = [&](size_t count) { return word.substr(0, word.size() - count); };
  const auto is_doubled = [](const std::string& stem) {
    return stem.size() > 2 && stem.back() == stem[stem.size() - 2] && stem.back() != 's' &&
           stem.back() != 'l';
  };
  const auto needs_e = [](const std::string& stem) {
    return is_any(
        stem, {"complet", "achiev", "arriv",  "caus", "describ", "retriev", "navigat", "prepar",
               "mov",     "plac",   "clos",   "us",   "driv",    "tak",     "handl",   "leav",
               "observ",  "notic",  "releas", "wip",  "receiv",  "remov",   "execut",  "captur"});
  };
  const auto stem_of = [&](std::string stem) {
    if (is_doubled(stem)) stem.pop_back();
    if (needs_e(stem) || stem.ends_with("cat") || stem.ends_with("gat") || stem.ends_with("ipulat"))
      stem += 'e';
    return stem;
  };
  if (word.size() > 5 && word.ends_with("ing")) return stem_of(without(3));
  if (word.size() > 4 && word.ends_with("ied")) return without(3) + "y";
  if (word.size() > 4 && word.ends_with("ed")) return stem_of(without(2));
  if (word.size() > 4 && word.ends_with("ies")) return without(3) + "y";
  if (word.size() > 4 && (word.ends_with("ches") || word.ends_with("shes"))) return without(2);
  if (word.size() > 3 && word.ends_with("s") && !word.ends_with("ss") && !word.ends_with("us"))
    return without(1);
  return word;
}

}  // namespace engram::speech
