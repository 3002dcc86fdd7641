// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/read_by_attention.h"

#include <algorithm>

#include "encoders/stored_tensors.h"
#include "speech/attention/program_symbols.h"
#include "speech/learning/attention_batch.h"
#include "speech/learning/attention_file.h"
#include "speech/learning/attention_weights.h"

namespace engram::speech {

namespace {

struct Beam {
  std::vector<int32_t> symbols;  ///< Without kBeginSymbol.
  double log_probability = 0;
  bool is_over = false;
};

AttentionBatch repeated(const AttentionBatch& batch, int64_t count) {
  const auto repeat = [count](const torch::Tensor& tensor) {
    std::vector<int64_t> sizes = tensor.sizes().vec();
    sizes.front() = count;
    return tensor.expand(sizes);
  };
  return {repeat(batch.words), repeat(batch.no_word), repeat(batch.attended),
          repeat(batch.no_attended), batch.groups};
}

torch::Tensor begun_by(const std::vector<Beam>& beams) {
  const size_t length = beams.front().symbols.size() + 1;
  torch::Tensor begun = torch::zeros(
      {static_cast<int64_t>(beams.size()), static_cast<int64_t>(length)}, torch::kInt32);
  for (size_t b = 0; b < beams.size(); ++b) {
    auto* const numbers = begun[static_cast<int64_t>(b)].data_ptr<int32_t>();
    numbers[0] = kBeginSymbol;
    std::copy(beams[b].symbols.begin(), beams[b].symbols.end(), numbers + 1);
  }
  return begun;
}

/// Searches the likeliest symbols.
std::vector<Beam> search(AttentionLayers& layers, const AttentionBatch& batch,
                         const torch::Tensor& read) {
  std::vector<Beam> going(1);
  std::vector<Beam> over;
  for (int64_t step = 0; step + 1 < AttentionShape::kMaxSymbols && !going.empty(); ++step) {
    const auto count = static_cast<int64_t>(going.size());
    const torch::Tensor told = layers->tell(read.expand({read.size(0), count, read.size(2)}),
                                            repeated(batch, count), begun_by(going));
    const torch::Tensor next =
        torch::log_softmax(layers->next_symbols(told[told.size(0) - 1]), 1).contiguous();
    std::vector<Beam> longer;
    const auto symbol_count = static_cast<size_t>(next.size(1));
    for (size_t b = 0; b < going.size(); ++b) {
      const float* const row = next.data_ptr<float>() + b * symbol_count;
      for (size_t symbol = 0; symbol < symbol_count; ++symbol) {
        if (symbol == kBeginSymbol) continue;
        Beam beam = going[b];
        beam.log_probability += static_cast<double>(row[symbol]);
        beam.symbols.push_back(static_cast<int32_t>(symbol));
        beam.is_over = symbol == kEndSymbol;
        longer.push_back(std::move(beam));
      }
    }
    const auto is_likelier = [](const Beam& a, const Beam& b) {
      return a.log_probability > b.log_probability;
    };
    const size_t kept = std::min(kReadings, longer.size());
    std::partial_sort(longer.begin(), longer.begin() + static_cast<ptrdiff_t>(kept), longer.end(),
                      is_likelier);
    longer.resize(kept);
    going.clear();
    for (Beam& beam : longer) (beam.is_over ? over : going).push_back(std::move(beam));
    std::sort(over.begin(), over.end(), is_likelier);
    // Nothing that goes on can become likelier than it is.
    if (over.size() >= kReadings && !going.empty() &&
        over[kReadings - 1].log_probability >= going.front().log_probability)
      break;
  }
  over.resize(std::min(over.size(), kReadings));
  return over;
}

class TorchAttention final : public AttentionNetwork {
 public:
  explicit TorchAttention(SavedAttention saved) : saved_(std::move(saved)) {}

  Result<AttentionScores> attend(const AttentionInput& input) override {
    return encoders::guarded("attention", [&]() -> Result<AttentionScores> {
      return read_by_attention(saved_.layers, input);
    });
  }
  [[nodiscard]] double min_confidence() const override { return saved_.record.min_confidence; }
  [[nodiscard]] double sure_confidence() const override { return saved_.record.sure_confidence; }

 private:
  SavedAttention saved_;
};

}  // namespace

AttentionScores read_by_attention(AttentionLayers& layers, const AttentionInput& input) {
  torch::InferenceMode inference;
  const AttentionBatch batch = batch_of(input);
  const torch::Tensor read = layers->read(batch);
  AttentionScores scores;
  for (const Beam& beam : search(layers, batch, read)) {
    AttentionScores::Reading reading{beam.symbols, beam.log_probability, {}, {}};
    const torch::Tensor told = layers->tell(read, batch, begun_by({beam}));
    reading.main = encoders::floats_of(layers->select(told[1], batch.groups, false));
    reading.main.resize(input.groups.size());
    if (const auto link = link_place(beam.symbols)) {
      const auto place = static_cast<int64_t>(*link) + 2;
      if (place < told.size(0)) {
        reading.other = encoders::floats_of(layers->select(told[place], batch.groups, true));
        reading.other.resize(input.groups.size());
      }
    }
    scores.readings.push_back(std::move(reading));
  }
  return scores;
}

Result<std::unique_ptr<AttentionNetwork>> load_attention(const std::filesystem::path& path) {
  return encoders::guarded("attention", [&]() -> Result<std::unique_ptr<AttentionNetwork>> {
    ENGRAM_ASSIGN_OR_RETURN(SavedAttention saved, read_attention(path));
    return std::unique_ptr<AttentionNetwork>(std::make_unique<TorchAttention>(std::move(saved)));
  });
}

}  // namespace engram::speech
