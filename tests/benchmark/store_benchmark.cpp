// SPDX-License-Identifier: Apache-2.0
// Recording and single reads of 128 x 128 images with 43 joints, beside PNG alone.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <random>

#include "ltm/codec/png.h"
#include "ltm/recall/recall.h"
#include "ltm/recording/recorder.h"

namespace engram::ltm {
namespace {

/// A gradient with a moving square and noise: compresses like a camera's image, not like zeros.
idf::NdArray picture(int index) {
  constexpr int kSide = 128;
  std::mt19937 random(static_cast<unsigned>(index));
  std::vector<uint8_t> pixels;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        const bool is_square = std::abs(x - 20 - index % 80) < 12 && std::abs(y - 60) < 12;
        pixels.push_back(static_cast<uint8_t>((is_square ? 200 : x + y / 2 + 20 * c) / 2 + random() % 4));
      }
  return idf::NdArray::take<uint8_t>({kSide, kSide, 3}, std::move(pixels));
}

Snapshot snapshot(int index) {
  const MemoryId entity = MemoryId::parse("Vision/RGB/head/cam").value();
  idf::Dict joints;
  for (int i = 0; i < 43; ++i)
    joints.set("joint_" + std::to_string(i), std::sin(0.01 * index + i));
  return {entity, time_from_ns(int64_t{200'000'000} * (index + 1)),
          {{idf::Dict{{"image", picture(index)}, {"joints", std::move(joints)}}, {}}}};
}

std::filesystem::path fresh_store() {
  const auto path = std::filesystem::temp_directory_path() / "engram_benchmark.engram";
  std::filesystem::remove_all(path);
  return path;
}

void png_alone(benchmark::State& state) {
  const idf::NdArray image = picture(0);
  for (auto _ : state) benchmark::DoNotOptimize(png_codec().encode(image));
}
BENCHMARK(png_alone);

void commit(benchmark::State& state) {
  const auto store = fresh_store();
  auto recorder = Recorder::open(store, {}).value();
  int index = 0;
  for (auto _ : state) {
    const Status status = recorder.commit({{snapshot(index++)}});
    if (!status.ok()) state.SkipWithError(status.message().c_str());
  }
  std::filesystem::remove_all(store);
}
BENCHMARK(commit)->Iterations(2000);

void read_nearest(benchmark::State& state) {
  const auto store = fresh_store();
  auto recorder = Recorder::open(store, {}).value();
  for (int i = 0; i < 1000; ++i) (void)recorder.commit({{snapshot(i)}});
  (void)recorder.close();
  Recall recall(StoreReader::open(store).value(), {});
  std::mt19937 random(1);
  for (auto _ : state) {
    const Time time = time_from_ns(static_cast<int64_t>(random() % 200'000) * 1'000'000);
    const auto query = Query::of_entity(snapshot(0).entity, select::Nearest{.time = time});
    benchmark::DoNotOptimize(recall.query(query));
  }
  std::filesystem::remove_all(store);
}
BENCHMARK(read_nearest);

}  // namespace
}  // namespace engram::ltm
