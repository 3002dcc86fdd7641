// SPDX-License-Identifier: Apache-2.0
// Conversions of the paper's simple and complex object, beside memcpy of the same bytes.
#include <benchmark/benchmark.h>

#include <cstring>

#include "ltm/idf/binary.h"
#include "ltm/idf/layout.h"

namespace engram::idf {
namespace {

Data simple_object() { return Dict{{"value", int64_t{42}}}; }

/// An image of 128 x 128 x 3 with a nested pose, links and a map of joints.
Data complex_object() {
  Dict joints;
  for (int i = 0; i < 43; ++i) joints.set("joint_" + std::to_string(i), 0.01f * static_cast<float>(i));
  return Dict{{"image", NdArray::take<uint8_t>({128, 128, 3}, std::vector<uint8_t>(49152, 127))},
              {"pose", Dict{{"position", NdArray::take<float>({3}, {1, 2, 3})},
                            {"orientation", NdArray::take<float>({4}, {1, 0, 0, 0})}}},
              {"joints", std::move(joints)},
              {"links", List{"Vision/RGB/head/cam", "RobotState/Proprioception/robot/joints"}}};
}

void encode_object(benchmark::State& state, const Data& object) {
  for (auto _ : state) benchmark::DoNotOptimize(encode(object));
  state.SetBytesProcessed(static_cast<int64_t>(state.iterations() * encoded_size(object)));
}

void decode_object(benchmark::State& state, const Data& object) {
  const Buffer bytes = Buffer::take(encode(object).value());
  for (auto _ : state) benchmark::DoNotOptimize(decode(bytes));
  state.SetBytesProcessed(static_cast<int64_t>(state.iterations() * bytes.size()));
}

void copy_bytes(benchmark::State& state, const Data& object) {
  const Buffer bytes = Buffer::take(encode(object).value());
  for (auto _ : state) {
    std::vector<std::byte> copy(bytes.size());
    std::memcpy(copy.data(), bytes.data(), bytes.size());
    benchmark::DoNotOptimize(copy.data());
  }
  state.SetBytesProcessed(static_cast<int64_t>(state.iterations() * bytes.size()));
}

void split_and_join(benchmark::State& state, const Data& object) {
  const Layout layout = Layout::of(object);
  for (auto _ : state) benchmark::DoNotOptimize(layout.join(layout.split(object).value()));
}

BENCHMARK_CAPTURE(encode_object, simple, simple_object());
BENCHMARK_CAPTURE(decode_object, simple, simple_object());
BENCHMARK_CAPTURE(encode_object, complex, complex_object());
BENCHMARK_CAPTURE(decode_object, complex, complex_object());
BENCHMARK_CAPTURE(copy_bytes, complex, complex_object());
BENCHMARK_CAPTURE(split_and_join, complex, complex_object());

}  // namespace
}  // namespace engram::idf
