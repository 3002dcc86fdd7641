// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/dialogue.h"

#include "speech/dialogues/lasting_hash.h"

namespace engram::speech {

namespace {

using dialogues::lasting_hash;

constexpr uint64_t kOneIn = 5;

}  // namespace

std::string to_json_line(const Dialogue& dialogue) {
  nlohmann::ordered_json also = nlohmann::ordered_json::array();
  for (const AnswerValue& value : dialogue.also) also.push_back(to_json(value));
  nlohmann::ordered_json evidence = nlohmann::ordered_json::array();
  for (const ltm::MemoryId& id : dialogue.evidence) evidence.push_back(id.to_string());
  const nlohmann::ordered_json line{{"id", dialogue.id},
                                    {"family", dialogue.family},
                                    {"form", dialogue.form},
                                    {"question", dialogue.question},
                                    {"phrasing", dialogue.phrasing},
                                    {"seed", dialogue.seed},
                                    {"now", to_string(dialogue.now)},
                                    {"value", to_json(dialogue.value)},
                                    {"also", also},
                                    {"evidence", evidence},
                                    {"answerable", !is_unknown(dialogue.value)},
                                    {"held_out", dialogue.held_out}};
  return line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

bool is_seed_held_out(int64_t seed) {
  return lasting_hash("seed " + std::to_string(seed)) % kOneIn == 0;
}

bool is_thing_held_out(const std::string& spoken_name) {
  return lasting_hash("thing " + spoken_name) % kOneIn == 0;
}

bool is_phrasing_held_out(const std::string& phrasing) {
  // The template, and then the words for the skill: both may be new to whoever is tried.
  const size_t verb = phrasing.find('/', phrasing.find('#'));
  if (lasting_hash(phrasing.substr(0, verb)) % kOneIn == 0) return true;
  return verb != std::string::npos && lasting_hash(phrasing.substr(verb)) % kOneIn == 0;
}

}  // namespace engram::speech
