// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/careless.h"

#include <algorithm>
#include <utility>

namespace engram::speech::dialogues {

namespace {

constexpr size_t kLongWord = 6;

bool is_letter(char one) {
  return (one >= 'a' && one <= 'z') || (one >= 'A' && one <= 'Z');
}

std::string small_without_marks(const std::string& text) {
  std::string small;
  for (size_t i = 0; i < text.size(); ++i) {
    const char one = text[i];
    // A colon within a time stays.
    const bool is_mark = one == '?' || one == '!' || one == ',' || one == '.';
    if (!is_mark) small += one >= 'A' && one <= 'Z' ? static_cast<char>(one - 'A' + 'a') : one;
  }
  return small;
}

/// Where the long words that are no names begin, with their lengths.
std::vector<std::pair<size_t, size_t>> long_words(const std::string& text,
                                                  const KnownAnswer& known) {
  std::string names = known.asked.thing + ' ' + known.asked.place;
  for (const auto& [slot, name] : known.slots) names += ' ' + name;
  std::vector<std::pair<size_t, size_t>> words;
  for (size_t i = 0; i < text.size();) {
    size_t end = i;
    while (end < text.size() && is_letter(text[end])) ++end;
    if (end - i >= kLongWord && names.find(text.substr(i, end - i)) == std::string::npos)
      words.emplace_back(i, end - i);
    i = std::max(end, i + 1);
  }
  return words;
}

}  // namespace

void put_carelessly(Dialogue& dialogue, const KnownAnswer& known, double share,
                    std::mt19937_64& random) {
  constexpr uint64_t kScale = 1'000'000;
  if (static_cast<double>(random() % kScale) >= share * static_cast<double>(kScale)) return;
  if (random() % 2 == 0) {
    dialogue.question = small_without_marks(dialogue.question);
    dialogue.phrasing += "+small";
    return;
  }
  const auto words = long_words(dialogue.question, known);
  if (words.empty()) return;
  const auto [begin, length] = words[random() % words.size()];
  // The first and the last letter stay, as in most slips of the fingers.
  const size_t at = begin + 1 + random() % (length - 3);
  std::swap(dialogue.question[at], dialogue.question[at + 1]);
  dialogue.phrasing += "+swapped";
}

}  // namespace engram::speech::dialogues
