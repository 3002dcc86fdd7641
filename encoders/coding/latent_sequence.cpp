// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/latent_sequence.h"

#include <xxhash.h>

#include <algorithm>

#include "encoders/coding/byte_stream.h"
#include "encoders/coding/checked_block.h"
#include "encoders/coding/latent_row_coder.h"
#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

/// Number of passes over the training data. One is not enough, because the first pass starts
/// untrained.
constexpr int kTrainingPasses = 2;

/// Codes stored numbers. Numbers that lie `period` apart share a model.
template <typename T, typename Port>
void code_numbers(Port& port, std::vector<T>& numbers, size_t period) {
  std::vector<IntegerModel> models(period * 2);
  int64_t before = 0;
  for (size_t i = 0; i < numbers.size(); ++i) {
    // Contexts that were never met come in runs, so the previous number predicts the next one.
    IntegerModel& model = models[(i % period) * 2 + (before == 0 ? 0 : 1)];
    before = model.code(port, numbers[i]);
    numbers[i] = static_cast<T>(before);
  }
}

}  // namespace

LatentModel::LatentModel(std::vector<LatentGrid> grids) : grids_(std::move(grids)) {
  ENGRAM_CHECK(!grids_.empty(), "no grids");
  for (const LatentGrid& grid : grids_)
    ENGRAM_CHECK(grid.channels > 0 && grid.height > 0 && grid.width > 0,
                 "a grid of {} x {} x {} latents", grid.channels, grid.height, grid.width);
  starts_.assign(LatentRowCoder::start_count(grids_), INT8_MIN);
  weights_.assign(LatentRowCoder::weight_count(grids_),
                  static_cast<int16_t>((1 << LatentMixer::kWeightBits) / 4));
}

LatentModel LatentModel::train(std::vector<LatentGrid> grids,
                               std::span<const std::vector<int32_t>> sequences) {
  LatentModel model(std::move(grids));
  const size_t latents = model.latents();
  for (int pass = 0; pass < kTrainingPasses; ++pass) {
    LatentRowCoder coder(model);
    BinaryListener listener;
    for (std::vector<int32_t> sequence : sequences) {
      ENGRAM_CHECK(sequence.size() % latents == 0, "{} latents in rows of {}", sequence.size(),
                   latents);
      coder.begin_block();
      for (size_t at = 0; at < sequence.size(); at += latents)
        coder.code_row(listener, std::span(sequence).subspan(at, latents));
    }
    coder.store(model);
  }
  return model;
}

uint64_t LatentModel::identity() const {
  ByteWriter sizes;
  sizes.put<uint64_t>(starts_.size());
  for (const LatentGrid& grid : grids_)
    for (const int size : {grid.channels, grid.height, grid.width}) sizes.put<int32_t>(size);
  const std::vector<std::byte> bytes = sizes.take();
  return XXH3_64bits(bytes.data(), bytes.size());
}

size_t LatentModel::latents() const {
  size_t sum = 0;
  for (const LatentGrid& grid : grids_) sum += grid.count();
  return sum;
}

std::vector<std::byte> LatentModel::to_bytes() const {
  BinaryEncoder encoder;
  // Zero is the cheapest number to code, so it stands for contexts that were never met.
  std::vector<int16_t> starts(starts_.begin(), starts_.end());
  for (int16_t& start : starts)
    start = static_cast<int16_t>(start == INT8_MIN ? 0 : start < 0 ? start : start + 1);
  std::vector<int16_t> weights = weights_;
  code_numbers(encoder, starts, kLatentNodes);
  code_numbers(encoder, weights, kLatentContexts + 1);
  return with_checksum(encoder.finish(), identity());
}

Result<LatentModel> LatentModel::from_bytes(std::span<const std::byte> bytes,
                                            std::vector<LatentGrid> grids) {
  LatentModel model(std::move(grids));
  ENGRAM_ASSIGN_OR_RETURN(const auto content,
                          without_checksum(bytes, "model of latents", model.identity()));
  BinaryDecoder decoder(content);
  std::vector<int16_t> starts(model.starts_.size());
  code_numbers(decoder, starts, kLatentNodes);
  std::ranges::transform(starts, model.starts_.begin(), [](int16_t start) {
    return static_cast<int8_t>(start == 0 ? INT8_MIN : start < 0 ? start : start - 1);
  });
  code_numbers(decoder, model.weights_, kLatentContexts + 1);
  return model;
}

std::vector<std::byte> LatentSequenceCodec::encode(std::span<const int32_t> latents) const {
  const size_t each = model_.latents();
  ENGRAM_CHECK(latents.size() % each == 0, "{} latents in rows of {}", latents.size(), each);
  LatentRowCoder coder(model_);
  BinaryEncoder encoder;
  std::vector<int32_t> row(each);
  for (size_t at = 0; at < latents.size(); at += each) {
    std::ranges::copy(latents.subspan(at, each), row.begin());
    coder.code_row(encoder, row);
  }
  return with_checksum(encoder.finish(), latents.size() / each);
}

Result<std::vector<int32_t>> LatentSequenceCodec::decode(std::span<const std::byte> block,
                                                         size_t rows, size_t wanted) const {
  ENGRAM_CHECK(wanted <= rows, "{} of {} rows", wanted, rows);
  ENGRAM_ASSIGN_OR_RETURN(const auto content, without_checksum(block, "block of latents", rows));
  const size_t each = model_.latents();
  LatentRowCoder coder(model_);
  BinaryDecoder decoder(content);
  std::vector<int32_t> latents(wanted * each);
  for (size_t at = 0; at < latents.size(); at += each)
    coder.code_row(decoder, std::span(latents).subspan(at, each));
  return latents;
}

std::vector<double> LatentSequenceCodec::cost_bits(std::span<const int32_t> latents) const {
  const size_t each = model_.latents();
  ENGRAM_CHECK(latents.size() % each == 0, "{} latents in rows of {}", latents.size(), each);
  LatentRowCoder coder(model_);
  std::vector<double> costs;
  std::vector<int32_t> row(each);
  for (size_t at = 0; at < latents.size(); at += each) {
    BitCounter counter;
    std::ranges::copy(latents.subspan(at, each), row.begin());
    coder.code_row(counter, row);
    costs.push_back(counter.bits());
  }
  return costs;
}

}  // namespace engram::encoders
