// SPDX-License-Identifier: Apache-2.0
// What codes cost: of an image, and a comparison with a million of them.
#include <benchmark/benchmark.h>

#include <random>

#include "ltm/likeness/coded_moments.h"
#include "ltm/likeness/image_descriptor.h"

namespace engram::ltm {
namespace {

/// `count` codes at 5 Hz, in recordings of a minute.
CodedMoments random_codes(size_t count) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> number(-40, 40);
  CodedMoments coded;
  coded.numbers = kCodeSize;
  for (size_t i = 0; i < count; ++i) {
    const auto recording = static_cast<int64_t>(i / 300);
    coded.times.push_back(
        time_from_ns(recording * 3'600'000'000'000 + static_cast<int64_t>(i) * 200'000'000));
    for (size_t j = 0; j < kCodeSize; ++j)
      coded.bytes.push_back(static_cast<int8_t>(number(random)));
  }
  coded.finish();
  return coded;
}

/// Arguments: codes, seconds of context.
void BM_CompareWithCodes(benchmark::State& state) {
  const CodedMoments coded = random_codes(static_cast<size_t>(state.range(0)));
  for (auto _ : state)
    benchmark::DoNotOptimize(
        coded.square_distances(coded.size() / 2, std::chrono::seconds(state.range(1))));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_CompareWithCodes)
    ->Args({1'000'000, 0})
    ->Args({1'000'000, 2})
    ->Args({10'000'000, 0})
    ->Args({10'000'000, 2})
    ->Unit(benchmark::kMillisecond);

/// Argument: the height of the image.
void BM_DescribeImage(benchmark::State& state) {
  const int64_t height = state.range(0), width = height * 4 / 3;
  std::mt19937 random(1);
  std::vector<uint8_t> pixels(static_cast<size_t>(height * width * 3));
  for (uint8_t& pixel : pixels) pixel = static_cast<uint8_t>(random());
  const auto image = idf::NdArray::take({height, width, 3}, std::move(pixels));
  for (auto _ : state) benchmark::DoNotOptimize(describe_image(image));
}
BENCHMARK(BM_DescribeImage)->Arg(128)->Arg(480)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace engram::ltm
