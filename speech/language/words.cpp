// SPDX-License-Identifier: Apache-2.0
#include "speech/language/words.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

#include "ltm/core/ascii.h"
#include "ltm/core/utf8.h"
#include "speech/language/word_pattern.h"

namespace engram::speech {

namespace {

struct Respelled {
  std::string_view given;
  std::string_view written;
};

/// What has no rule of its own below.
constexpr Respelled kContractions[] = {
    {"u", "you"},           {"ur", "your"},           {"r", "are"},
    {"wat", "what"},        {"wut", "what"},          {"teh", "the"},
    {"wen", "when"},        {"whn", "when"},          {"wher", "where"},
    {"whre", "where"},      {"wich", "which"},        {"oftn", "often"},
    {"ofen", "often"},      {"dont", "do not"},       {"doesnt", "does not"},
    {"isnt", "is not"},     {"ive", "i have"},        {"youve", "you have"},
    {"havent", "have not"}, {"hasnt", "has not"},     {"wouldnt", "would not"},
    {"hadnt", "had not"},   {"werent", "were not"},   {"arent", "are not"},
    {"pls", "please"},      {"plz", "please"},        {"smth", "something"},
    {"o'clock", "oclock"},  {"yer", "your"},          {"ya", "you"},
    {"em", "them"},         {"won't", "will not"},    {"can't", "can not"},
    {"cannot", "can not"},  {"shan't", "shall not"},  {"let's", "let us"},
    {"what's", "what is"},  {"where's", "where is"},  {"who's", "who is"},
    {"when's", "when is"},  {"how's", "how is"},      {"why's", "why is"},
    {"that's", "that is"},  {"it's", "it is"},        {"there's", "there is"},
    {"whats", "what is"},   {"wheres", "where is"},   {"whos", "who is"},
    {"didnt", "did not"},   {"couldnt", "could not"}, {"wasnt", "was not"},
    {"whatd", "what did"},  {"gonna", "going to"},
};

constexpr std::array<Respelled, 6> kEndings{{
    {"n't", " not"},
    {"'re", " are"},
    {"'ve", " have"},
    {"'ll", " will"},
    {"'d", " 'd"},
    {"'m", " am"},
}};

/// Whether letters that are no English ones are part of the text.
bool is_foreign(char32_t code) {
  // Accents of names and foreign words in English end with Latin Extended-A.
  return code > 0x17F && !(code >= 0x2000 && code <= 0x206F) && code != 0x20AC;
}

bool is_word_sign(std::string_view text, size_t at) {
  const char c = text[at];
  if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80)
    return true;
  if (at == 0 || at + 1 >= text.size()) return false;
  const auto is_digit = [&](size_t index) { return text[index] >= '0' && text[index] <= '9'; };
  const auto is_letter = [&](size_t index) { return text[index] >= 'a' && text[index] <= 'z'; };
  // 8:05:12.5 and 2026-01-02 are words, and so is "didn't"; "pick-up" is two.
  if (c == ':' || c == '.' || c == '-') return is_digit(at - 1) && is_digit(at + 1);
  return c == '\'' && is_letter(at - 1) && is_letter(at + 1);
}

/// Control characters are spaces, curly quotes straight ones.
Result<std::string> plain_text(std::string_view question) {
  std::string plain;
  size_t letters = 0;
  size_t foreign = 0;
  while (!question.empty()) {
    const Utf8Character character = first_character(question);
    if (character.bytes == 0) return invalid_argument("the question is no text");
    const char32_t code = character.code;
    if (code == 0x2018 || code == 0x2019 || code == 0x2BC || code == 0x60)
      plain += '\'';
    else if (code < 0x20 || code == 0x7F || (code >= 0x2000 && code <= 0x206F))
      plain += ' ';
    else
      plain += question.substr(0, character.bytes);
    if (is_foreign(code)) ++foreign;
    if (code >= 'A') ++letters;
    question.remove_prefix(character.bytes);
  }
  if (foreign > 0 && foreign * 4 > letters)
    return invalid_argument("I understand questions in English only");
  return plain;
}

std::string written_out(const std::string& word) {
  for (const Respelled& respelled : kContractions)
    if (word == respelled.given) return std::string(respelled.written);
  for (const Respelled& ending : kEndings)
    if (word.size() > ending.given.size() && word.ends_with(ending.given))
      return word.substr(0, word.size() - ending.given.size()) + std::string(ending.written);
  // "the robot's plan"
  if (word.ends_with("'s")) return word.substr(0, word.size() - 2);
  return word;
}

/// Says what "'d" is: "where'd you put it" is did, "you'd been" is had, "I'd like" is would.
void write_out_d(std::vector<QuestionWord>& words) {
  for (size_t at = 1; at < words.size(); ++at) {
    if (words[at].text != "'d") continue;
    size_t next = at + 1;
    while (next < words.size() &&
           is_any(words[next].text, {"not", "just", "ever", "already", "also"}))
      ++next;
    const std::string verb = next < words.size() ? words[next].text : std::string();
    if (is_any(words[at - 1].text, {"where", "what", "who", "why", "how", "when", "which"}))
      words[at].text = verb == "have" ? "would" : "did";
    else
      words[at].text = lemma_of(verb) == verb ? "would" : "had";
  }
}

/// Signs that no question in English has, and queries, markup and code have.
constexpr std::string_view kSignsOfCode = "*{}\\|";

}  // namespace

Result<std::vector<QuestionWord>> split_words(std::string_view question) {
  if (question.size() > kMaxQuestionBytes)
    return invalid_argument("the question has {} bytes, and I read at most {}", question.size(),
                            kMaxQuestionBytes);
  ENGRAM_ASSIGN_OR_RETURN(const std::string plain, plain_text(question));
  if (plain.find_first_of(kSignsOfCode) != std::string::npos)
    return invalid_argument("there are signs of a program in it, and I read English");
  const std::string lower = lower_ascii(plain);
  std::vector<QuestionWord> words;
  bool begins = true;
  for (size_t at = 0; at < lower.size();) {
    if (!is_word_sign(lower, at)) {
      const char sign = lower[at++];
      const bool ends_sentence = sign == '.' || sign == '?' || sign == '!' || sign == ';';
      if (ends_sentence) begins = true;
      if ((ends_sentence || sign == ',' || sign == ':') && !words.empty())
        words.back().ends_clause = true;
      if ((sign == '.' || sign == '!') && !words.empty()) words.back().ends_statement = true;
      continue;
    }
    const size_t begin = at;
    while (at < lower.size() && is_word_sign(lower, at)) ++at;
    const std::string given = plain.substr(begin, at - begin);
    const bool is_capital = given.front() >= 'A' && given.front() <= 'Z' && given.size() > 1 &&
                            given[1] >= 'a' && given[1] <= 'z';
    const std::string written = written_out(lower.substr(begin, at - begin));
    for (const std::string_view word : parts_between(written, ' ')) {
      words.push_back({std::string(word), given, begins, is_capital, false});
      begins = false;
    }
    if (words.size() > kMaxQuestionWords)
      return invalid_argument("the question has more than {} words", kMaxQuestionWords);
  }
  if (words.empty()) return invalid_argument("there is no question");
  words.back().ends_clause = true;
  write_out_d(words);
  return words;
}

int number_named(std::string_view word) {
  constexpr std::array<std::string_view, 21> kNumbers{
      "zero",     "one",     "two",     "three",     "four",     "five",     "six",
      "seven",    "eight",   "nine",    "ten",       "eleven",   "twelve",   "thirteen",
      "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen", "twenty"};
  constexpr std::array<std::pair<std::string_view, int>, 10> kMore{{{"thirty", 30},
                                                                    {"forty", 40},
                                                                    {"fifty", 50},
                                                                    {"sixty", 60},
                                                                    {"seventy", 70},
                                                                    {"eighty", 80},
                                                                    {"ninety", 90},
                                                                    {"hundred", 100},
                                                                    {"a", 1},
                                                                    {"an", 1}}};
  for (size_t i = 0; i < kNumbers.size(); ++i)
    if (word == kNumbers.at(i)) return static_cast<int>(i);
  for (const auto& [name, number] : kMore)
    if (word == name) return number;
  int number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size() && number >= 0 &&
                 number <= 1'000'000
             ? number
             : -1;
}

namespace {

/// A bit for each letter that a word has; what is no letter shares a few.
uint32_t letters_of(std::string_view word) {
  uint32_t letters = 0;
  for (const char letter : word)
    letters |= uint32_t{1} << (static_cast<unsigned char>(letter) % 32);
  return letters;
}

}  // namespace

int letters_apart(std::string_view a, std::string_view b, int max) {
  const auto length = [](std::string_view text) { return static_cast<int>(text.size()); };
  if (std::abs(length(a) - length(b)) > max) return max + 1;
  // A word is compared with thousands. Each change brings one letter that the other has not at
  // most.
  const uint32_t of_a = letters_of(a), of_b = letters_of(b);
  if (std::popcount(of_a & ~of_b) > max || std::popcount(of_b & ~of_a) > max) return max + 1;
  // Optimal string alignment, of which only the last three rows are needed.
  std::vector<int> before_last, last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) last[j] = static_cast<int>(j);
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(i);
    int min_of_row = row[0];
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      min_of_row = std::min(min_of_row, row[j]);
    }
    before_last.swap(last);
    last.swap(row);
    row.resize(b.size() + 1);
    // Two letters that change places lead from the row before this one, too.
    const int min_before = *std::min_element(before_last.begin(), before_last.end());
    if (std::min(min_of_row, min_before) > max) return max + 1;
  }
  return std::min(last[b.size()], max + 1);
}

}  // namespace engram::speech
