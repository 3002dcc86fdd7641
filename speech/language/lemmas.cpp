// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>

#include "speech/language/words.h"

namespace engram::speech {

namespace {

const std::map<std::string_view, std::string_view>& irregular_forms() {
  static const std::map<std::string_view, std::string_view> kForms{{"took", "take"},
                                                                   {"taken", "take"},
                                                                   {"got", "get"},
                                                                   {"gotten", "get"},
                                                                   {"drove", "drive"},
                                                                   {"driven", "drive"},
                                                                   {"went", "go"},
                                                                   {"gone", "go"},
                                                                   {"saw", "see"},
                                                                   {"seen", "see"},
                                                                   {"held", "hold"},
                                                                   {"brought", "bring"},
                                                                   {"said", "say"},
                                                                   {"told", "tell"},
                                                                   {"spoke", "speak"},
                                                                   {"spoken", "speak"},
                                                                   {"came", "come"},
                                                                   {"found", "find"},
                                                                   {"gave", "give"},
                                                                   {"given", "give"},
                                                                   {"began", "begin"},
                                                                   {"begun", "begin"},
                                                                   {"did", "do"},
                                                                   {"done", "do"},
                                                                   {"doing", "do"},
                                                                   {"does", "do"},
                                                                   {"made", "make"},
                                                                   {"kept", "keep"},
                                                                   {"fell", "fall"},
                                                                   {"fallen", "fall"},
                                                                   {"broke", "break"},
                                                                   {"broken", "break"},
                                                                   {"wanted", "want"},
                                                                   {"stood", "stand"},
                                                                   {"lost", "lose"},
                                                                   {"had", "have"},
                                                                   {"has", "have"},
                                                                   {"having", "have"},
                                                                   {"was", "be"},
                                                                   {"were", "be"},
                                                                   {"is", "be"},
                                                                   {"are", "be"},
                                                                   {"been", "be"},
                                                                   {"being", "be"},
                                                                   {"am", "be"},
                                                                   {"tried", "try"},
                                                                   {"tries", "try"},
                                                                   {"retried", "retry"},
                                                                   {"carried", "carry"},
                                                                   {"carries", "carry"},
                                                                   {"stopped", "stop"},
                                                                   {"stopping", "stop"},
                                                                   {"putting", "put"},
                                                                   {"setting", "set"},
                                                                   {"grabbed", "grab"},
                                                                   {"grabbing", "grab"},
                                                                   {"dropped", "drop"},
                                                                   {"dropping", "drop"},
                                                                   {"getting", "get"},
                                                                   {"gripped", "grip"},
                                                                   {"spotted", "spot"},
                                                                   {"laid", "lay"},
                                                                   {"left", "left"},
                                                                   {"leaving", "leave"},
                                                                   {"ran", "run"},
                                                                   {"running", "run"},
                                                                   {"goes", "go"},
                                                                   {"forgot", "forget"},
                                                                   {"things", "thing"},
                                                                   {"objects", "object"},
                                                                   {"happened", "happen"},
                                                                   {"happening", "happen"},
                                                                   {"worked", "work"},
                                                                   {"working", "work"},
                                                                   {"needed", "need"},
                                                                   {"asked", "ask"},
                                                                   {"stuck", "stuck"},
                                                                   {"wrong", "wrong"},
                                                                   {"this", "this"},
                                                                   {"his", "his"},
                                                                   {"times", "time"},
                                                                   {"failure", "fail"},
                                                                   {"failures", "fail"},
                                                                   {"success", "succeed"},
                                                                   {"successful", "succeed"},
                                                                   {"successfully", "succeed"},
                                                                   {"unsuccessful", "fail"},
                                                                   {"unsuccessfully", "fail"},
                                                                   {"picking", "pick"},
                                                                   {"grasp", "grasp"},
                                                                   {"moved", "move"},
                                                                   {"managed", "manage"},
                                                                   {"lying", "lie"},
                                                                   {"lay", "lay"},
                                                                   {"sat", "sit"},
                                                                   {"used", "use"},
                                                                   {"using", "use"},
                                                                   {"placed", "place"},
                                                                   {"placing", "place"},
                                                                   {"seeing", "see"},
                                                                   {"lifted", "lift"},
                                                                   {"thought", "think"},
                                                                   {"knew", "know"},
                                                                   {"interrupted", "interrupt"},
                                                                   {"achieved", "achieve"},
                                                                   {"during", "during"},
                                                                   {"nothing", "nothing"},
                                                                   {"something", "something"},
                                                                   {"anything", "anything"},
                                                                   {"everything", "everything"},
                                                                   {"morning", "morning"},
                                                                   {"evening", "evening"},
                                                                   {"always", "always"},
                                                                   {"was", "be"},
                                                                   {"perhaps", "perhaps"},
                                                                   {"yes", "yes"},
                                                                   {"going", "go"},
                                                                   {"placement", "place"},
                                                                   {"interruption", "interrupt"},
                                                                   {"interruptions", "interrupt"},
                                                                   {"stoppage", "stop"},
                                                                   {"quitting", "quit"},
                                                                   {"heard", "hear"},
                                                                   {"made", "make"},
                                                                   {"delivery", "bring"},
                                                                   {"trip", "drive"},
                                                                   {"trips", "drive"},
                                                                   {"journey", "drive"},
                                                                   {"journeys", "drive"},
                                                                   {"lasted", "endure"},
                                                                   {"us", "us"},
                                                                   {"as", "as"},
                                                                   {"bring", "bring"},
                                                                   {"thing", "thing"},
                                                                   {"red", "red"},
                                                                   {"need", "need"},
                                                                   {"bed", "bed"},
                                                                   {"speed", "speed"},
                                                                   {"hundred", "hundred"},
                                                                   {"indeed", "indeed"},
                                                                   {"does", "do"},
                                                                   {"less", "less"},
                                                                   {"across", "across"},
                                                                   {"else", "else"},
                                                                   {"glass", "glass"},
                                                                   {"across", "across"}};
  return kForms;
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
    constexpr std::array<std::string_view, 20> kStems{
        "complet", "achiev", "arriv",  "caus",  "describ", "retriev", "navigat",
        "prepar",  "mov",    "plac",   "clos",  "us",      "driv",    "tak",
        "handl",   "leav",   "observ", "notic", "releas",  "wip"};
    return std::find(kStems.begin(), kStems.end(), stem) != kStems.end();
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
