// SPDX-License-Identifier: Apache-2.0
#include "speech/language/english.h"

#include "speech/language/word_pattern.h"
#include "speech/program/skill_verbs.h"

namespace engram::speech {

namespace {

constexpr std::string_view kGrammarLemmas =
    "where when who whom whose why how which what whichever whether if unless do happen occur see "
    "notice observe perceive view visible sight hold carry grip keep have be ask tell say speak "
    "talk request order command want instruct call demand shout utter mention fail succeed manage "
    "accomplish achieve work error mistake problem trouble issue wrong difficulty mishap mess "
    "miss lose slip fall unable able could not never no nobody nothing none stop interrupt halt "
    "abort cancel pause break prevent hinder block disturb retry again try attempt twice second "
    "third fourth fifth first last latest final recent initial earliest previous next once would "
    "hand arm gripper fist side use long longer shorter far distance often many much more less "
    "fewer than time duration minute metre meter take need require spend finish end complete "
    "start begin everything anything something anybody anyone somebody someone everyone everybody "
    "all any some thing object item stuff it them that this those these he she they there here "
    "one before after while during right directly immediately just then now stand robot you "
    "yourself task job plan step action activity from to into onto on in at off with without "
    "under of by for down up over out back near beside and or touch handle manipulate move bring "
    "transport shift relocate quit hear skill furniture piece perform execute conduct know badly "
    "amiss awry outcome result status clue motivation drop slower faster quicker free hands goes "
    "cover repeat deal surface endure idle inactive active run location position whereabouts "
    "place reason cause purpose instead otherwise else go count number total different distinct "
    "person human people summary summarize summarise describe report narrate recap list remember "
    "recall day left leave look search find pick put grasp grab drive navigate smoothly fine well "
    "okay ok good intend intention remain rest busy occupied about story longest shortest "
    "quickest slowest fastest compare same both either still except besides behind summer winter "
    "spring autumn year month already yet away word sentence instruction come travel arrive reach "
    "stay located sit lie lay possess current empty full change receive continue achievement "
    "success destination called each detect appear closer nearer average newest oldest event "
    "behalf colour";

constexpr std::string_view kFillers =
    "a an the my your our his her their its i me we us mine yours ours please kindly thanks thank "
    "hello hi hey dear sorry excuse okay so well ah oh um uh hmm actually really exactly "
    "precisely currently possibly maybe perhaps probably ever even also too very quite rather bit "
    "little only earlier later lately recently previously originally eventually finally meanwhile "
    "moment while ago today yesterday kitchen room house home buddy robot friend mate sir madam "
    "know knew remember recall think guess suppose believe wonder curious interested interest "
    "question answer info information detail details memory log record records history as but "
    "because though although since than is are was were am be been being do does did done have "
    "has had can could will would shall should may might must let get got such kind sort type way "
    "case point fact part over course certain sure clear clearly quickly slowly carefully "
    "successfully properly correctly actual exact particular specific respectively altogether "
    "overall together apart alone along around round across away everything guy guys folks want "
    "wanted need needed wish help quick short brief briefly give show explain tell say make made "
    "double check see seem seems reckon appear appears today's day days hour hours minute minutes "
    "seconds second time times session shift run recording episode same other another each every "
    "own whole entire lot lots few several couple new old big small nice great good bad right "
    "wrong left early late long ok fine cool alright yes no not n't nope yeah yep you self itself "
    "myself there here what's up any according chance happen happened possible mind minding "
    "afterwards afterward beforehand thereafter onwards physically personally somehow somewhere "
    "anywhere everywhere sometime sometimes always usually normally apparently supposedly "
    "allegedly anyway anyhow looking trying going supposed meant able asking hear heard learn "
    "learned learnt find remind reminded mean means most least much many enough almost nearly "
    "approximately s t ll ve re d m o clock hm er eh again instead inside outside within upon via "
    "per mr mrs ms miss dr anymore longer whatever whenever wherever everybody anybody tonight "
    "morning afternoon evening night week recent past present previous current hold on wait "
    "listen look back january february march april june july august september october november "
    "december monday tuesday wednesday thursday friday saturday sunday noon midnight between "
    "until till pm tomorrow sudden suddenly pls plz ways process cases line world matter hitch "
    "single effort efforts others aside instant boss mischief doings unique various occasion "
    "occasions freshest path route ground stretch length hope hoping name named form sense order "
    "sequence account list precise subsequent ultimate major main procedure operation performance "
    "approach method subject topic data evidence trace proof hint statement response reply "
    "inquiry query period interval span spell stint timeframe beginning middle respect regard "
    "regards terms available given fun surely simply merely likely source target argument id turn "
    "sweetheart understand understood thou didst";

void add_words(std::string_view list, std::set<std::string>& words) {
  for (const std::string_view word : parts_between(list, ' ')) words.emplace(word);
}

const std::set<std::string>& grammar_lemmas() {
  static const std::set<std::string> kWords = [] {
    std::set<std::string> words;
    add_words(kGrammarLemmas, words);
    for (const SkillVerb& verb : skill_verbs()) add_words(verb.lemmas, words);
    return words;
  }();
  return kWords;
}

const std::set<std::string>& fillers() {
  static const std::set<std::string> kWords = [] {
    std::set<std::string> words;
    add_words(kFillers, words);
    return words;
  }();
  return kWords;
}

}  // namespace

bool is_grammar_lemma(const std::string& lemma) {
  return grammar_lemmas().contains(lemma);
}

bool is_filler(const std::string& word) {
  return fillers().contains(word) || (word.size() > 4 && word.ends_with("ly"));
}

bool is_question_word(std::string_view word) {
  return is_any(word, {"who", "whom", "whose", "what", "which", "where", "when", "why", "how"});
}

bool is_auxiliary(std::string_view word) {
  return is_any(word, {"did", "do", "does", "have", "has", "had", "is", "are", "was", "were", "am",
                       "can", "could", "would", "will", "should"});
}

bool is_article(std::string_view word) {
  return is_any(word, {"the", "a", "an", "my", "your", "our", "his", "her", "their", "any", "some",
                       "this", "that", "these", "those", "another"});
}

const std::set<std::string>& english_spellings() {
  static const std::set<std::string> kSpellings = [] {
    std::set<std::string> spellings;
    const auto add = [&](const std::string& word) {
      spellings.insert(word);
      const bool has_e = word.back() == 'e';
      for (const char* ending : {"s", has_e ? "d" : "ed"}) spellings.insert(word + ending);
      spellings.insert((has_e ? word.substr(0, word.size() - 1) : word) + "ing");
      if (word.back() == 'p' || word.back() == 'b' || word.back() == 't')
        for (const char* ending : {"ed", "ing"}) spellings.insert(word + word.back() + ending);
    };
    for (const std::string& word : grammar_lemmas()) add(word);
    for (const std::string& word : fillers()) spellings.insert(word);
    for (const std::string& word : irregular_words()) spellings.insert(word);
    return spellings;
  }();
  return kSpellings;
}

}  // namespace engram::speech
