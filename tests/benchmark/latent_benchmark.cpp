// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>

#include "encoders/coding/latent_sequence.h"

namespace engram::encoders {
namespace {

/// Those of an image of 128 x 128 pixels.
const std::vector<LatentGrid> kGrids{{24, 8, 8}, {4, 16, 16}};
constexpr size_t kLatents = 24 * 8 * 8 + 4 * 16 * 16;
constexpr size_t kBlockRows = 16;

/// Rows as trained networks make them: some channels are busy, most latents stay or are zero.
std::vector<int32_t> some_rows(unsigned seed) {
  std::mt19937 random(seed);
  std::geometric_distribution<int> size(0.6);
  std::vector<int32_t> latents(kBlockRows * kLatents);
  for (size_t i = 0; i < latents.size(); ++i) {
    const bool is_busy = i % kLatents / 64 % 5 == 0;
    const bool is_new = random() % 1000 < (is_busy ? 150 : 5);
    const int32_t last = i < kLatents ? 0 : latents[i - kLatents];
    latents[i] = is_new ? size(random) * (random() % 2 == 0 ? 1 : -1) : last;
  }
  return latents;
}

/// One snapshot alone: the latents of the rows up to it. The argument is how many.
void decode_first_rows(benchmark::State& state) {
  const auto rows = static_cast<size_t>(state.range(0));
  const std::vector<std::vector<int32_t>> lesson{some_rows(1), some_rows(2), some_rows(3)};
  const LatentSequenceCodec codec(LatentModel::train(kGrids, lesson));
  const std::vector<std::byte> block = codec.encode(some_rows(4));
  for (auto _ : state) benchmark::DoNotOptimize(codec.decode(block, kBlockRows, rows));
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * rows * kLatents));
  state.counters["block_bytes"] = static_cast<double>(block.size());
}
BENCHMARK(decode_first_rows)->Arg(1)->Arg(8)->Arg(16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::encoders
