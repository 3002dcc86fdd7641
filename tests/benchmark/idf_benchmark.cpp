// SPDX-License-Identifier: Apache-2.0
// Conversions of the paper's objects, each step apart, in batches; beside memcpy of the same bytes.
#include <benchmark/benchmark.h>

#include <cstring>

#include "ltm/idf/binary.h"
#include "ltm/idf/layout.h"
#include "tests/benchmark/paper_objects_example.h"

namespace engram::benchmark_objects {
namespace {

// Names read "<step>/<object>/<batch>"; times are of one object, not of the batch.

template <typename F>
void run_batches(benchmark::State& state, size_t bytes, F step) {
  const int64_t batch = state.range(0);
  for (auto _ : state)
    for (int64_t i = 0; i < batch; ++i) step();
  state.SetItemsProcessed(state.iterations() * batch);
  state.SetBytesProcessed(state.iterations() * batch * static_cast<int64_t>(bytes));
  state.counters["per_object"] =
      benchmark::Counter(static_cast<double>(state.iterations() * batch),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <typename Object>
void object_to_idf(benchmark::State& state) {
  const auto object = example<Object>();
  run_batches(state, idf::encoded_size(object.to_idf()),
              [&] { benchmark::DoNotOptimize(object.to_idf()); });
}

template <typename Object>
void idf_to_bytes(benchmark::State& state) {
  const idf::Data data = example<Object>().to_idf();
  run_batches(state, idf::encoded_size(data), [&] { benchmark::DoNotOptimize(idf::encode(data)); });
}

template <typename Object>
void bytes_to_idf(benchmark::State& state) {
  const Buffer bytes = Buffer::take(idf::encode(example<Object>().to_idf()).value());
  run_batches(state, bytes.size(), [&] { benchmark::DoNotOptimize(idf::decode(bytes)); });
}

template <typename Object>
void idf_to_object(benchmark::State& state) {
  const idf::Data data = example<Object>().to_idf();
  run_batches(state, idf::encoded_size(data),
              [&] { benchmark::DoNotOptimize(Object::from_idf(data)); });
}

template <typename Object>
void memcpy_of_bytes(benchmark::State& state) {
  const Buffer bytes = Buffer::take(idf::encode(example<Object>().to_idf()).value());
  std::vector<std::byte> copy(bytes.size());
  run_batches(state, bytes.size(), [&] {
    std::memcpy(copy.data(), bytes.data(), bytes.size());
    benchmark::DoNotOptimize(copy.data());
    benchmark::ClobberMemory();
  });
}

template <typename Object>
void split_and_join(benchmark::State& state) {
  const idf::Data data = example<Object>().to_idf();
  const idf::Layout layout = idf::Layout::of(data);
  run_batches(state, idf::encoded_size(data),
              [&] { benchmark::DoNotOptimize(layout.join(layout.split(data).value())); });
}

#define ENGRAM_OBJECT_BENCHMARKS(Object)                                      \
  BENCHMARK_TEMPLATE(object_to_idf, Object)->Arg(1)->Arg(20)->Arg(50)->Arg(100);   \
  BENCHMARK_TEMPLATE(idf_to_bytes, Object)->Arg(1)->Arg(20)->Arg(50)->Arg(100);    \
  BENCHMARK_TEMPLATE(bytes_to_idf, Object)->Arg(1)->Arg(20)->Arg(50)->Arg(100);    \
  BENCHMARK_TEMPLATE(idf_to_object, Object)->Arg(1)->Arg(20)->Arg(50)->Arg(100);   \
  BENCHMARK_TEMPLATE(memcpy_of_bytes, Object)->Arg(1)->Arg(100);                   \
  BENCHMARK_TEMPLATE(split_and_join, Object)->Arg(1)

ENGRAM_OBJECT_BENCHMARKS(Simple);
ENGRAM_OBJECT_BENCHMARKS(Moderate);
ENGRAM_OBJECT_BENCHMARKS(Complex);

}  // namespace
}  // namespace engram::benchmark_objects
