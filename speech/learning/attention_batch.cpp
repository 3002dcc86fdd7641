// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/attention_batch.h"

#include <algorithm>

#include "speech/attention/program_symbols.h"

namespace engram::speech {

namespace {

constexpr auto kPartsPerWord = static_cast<int64_t>(AttentionInput::kPartsPerWord);
constexpr auto kTraits = static_cast<int64_t>(AttentionInput::kTraits);

/// The largest size of a part, and 1 at least.
template <typename Of>
int64_t largest(std::span<const AttentionExample* const> examples, const Of& of) {
  size_t size = 1;
  for (const AttentionExample* one : examples) size = std::max(size, of(*one));
  return static_cast<int64_t>(size);
}

void fill_words(const std::vector<AttentionInput::Word>& words, int32_t* numbers, bool* is_none) {
  for (size_t i = 0; i < words.size(); ++i) {
    std::copy(words[i].begin(), words[i].end(), numbers + i * words[i].size());
    is_none[i] = false;
  }
}

void fill_traits(const AttentionInput::Traits& traits, float* numbers) {
  std::copy(traits.begin(), traits.end(), numbers);
}

void fill_flags(const std::vector<uint8_t>& flags, float* numbers) {
  for (size_t i = 0; i < flags.size(); ++i)
    numbers[i] = flags[i] == 2 ? -1.0F : static_cast<float>(flags[i]);
}

torch::Tensor numbers_of(std::initializer_list<int64_t> shape) {
  return torch::zeros(shape, torch::kInt32);
}

}  // namespace

LearnedBatch batch_of(std::span<const AttentionExample* const> examples) {
  const auto count = static_cast<int64_t>(examples.size());
  const int64_t words = largest(examples, [](const auto& one) { return one.words.size(); });
  const int64_t attended = largest(examples, [](const auto& one) { return one.attended.size(); });
  const int64_t groups = largest(examples, [](const auto& one) { return one.groups.size(); });
  const int64_t symbols = largest(examples, [](const auto& one) { return one.symbols.size(); });
  LearnedBatch batch;
  AttentionBatch& questions = batch.questions;
  questions.words = numbers_of({count, words, kPartsPerWord});
  questions.no_word = torch::ones({count, words}, torch::kBool);
  questions.attended = torch::zeros({count, attended, kTraits});
  questions.no_attended = torch::ones({count, attended}, torch::kBool);
  questions.groups = torch::zeros({count, groups, kTraits});
  batch.begun = numbers_of({count, symbols});
  batch.symbols = torch::full({count, symbols}, -1, torch::kInt32);
  batch.main = torch::full({count, groups}, -1.0);
  batch.other = torch::full({count, groups}, -1.0);
  batch.link = numbers_of({count});
  for (int64_t b = 0; b < count; ++b) {
    const AttentionExample& one = *examples[static_cast<size_t>(b)];
    fill_words(one.words, questions.words[b].data_ptr<int32_t>(),
               questions.no_word[b].data_ptr<bool>());
    float* const traits = questions.groups[b].data_ptr<float>();
    for (size_t i = 0; i < one.groups.size(); ++i)
      fill_traits(unpacked(one.groups[i]), traits + i * AttentionInput::kTraits);
    float* const of_attended = questions.attended[b].data_ptr<float>();
    bool* const no_attended = questions.no_attended[b].data_ptr<bool>();
    for (size_t i = 0; i < one.attended.size(); ++i) {
      fill_traits(unpacked(one.groups[one.attended[i]]), of_attended + i * AttentionInput::kTraits);
      no_attended[i] = false;
    }
    int32_t* const begun = batch.begun[b].data_ptr<int32_t>();
    int32_t* const told = batch.symbols[b].data_ptr<int32_t>();
    begun[0] = kBeginSymbol;
    for (size_t i = 0; i < one.symbols.size(); ++i) {
      told[i] = one.symbols[i];
      if (i + 1 < one.symbols.size()) begun[i + 1] = one.symbols[i];
    }
    fill_flags(one.main, batch.main[b].data_ptr<float>());
    fill_flags(one.other, batch.other[b].data_ptr<float>());
    // Behind kBeginSymbol everything is one further on, and the source follows the link.
    if (const auto link = link_place(one.symbols); link && !one.other.empty())
      batch.link[b] = static_cast<int32_t>(*link) + 2;
  }
  return batch;
}

AttentionBatch batch_of(const AttentionInput& input) {
  const auto words = static_cast<int64_t>(std::max<size_t>(input.words.size(), 1));
  const auto attended = static_cast<int64_t>(std::max<size_t>(input.attended.size(), 1));
  const auto groups = static_cast<int64_t>(std::max<size_t>(input.groups.size(), 1));
  AttentionBatch batch;
  batch.words = numbers_of({1, words, kPartsPerWord});
  batch.no_word = torch::ones({1, words}, torch::kBool);
  batch.attended = torch::zeros({1, attended, kTraits});
  batch.no_attended = torch::ones({1, attended}, torch::kBool);
  batch.groups = torch::zeros({1, groups, kTraits});
  fill_words(input.words, batch.words.data_ptr<int32_t>(), batch.no_word.data_ptr<bool>());
  for (size_t i = 0; i < input.groups.size(); ++i)
    fill_traits(input.groups[i], batch.groups.data_ptr<float>() + i * AttentionInput::kTraits);
  for (size_t i = 0; i < input.attended.size(); ++i) {
    fill_traits(input.groups[input.attended[i]],
                batch.attended.data_ptr<float>() + i * AttentionInput::kTraits);
    batch.no_attended.data_ptr<bool>()[i] = false;
  }
  return batch;
}

}  // namespace engram::speech
