// SPDX-License-Identifier: Apache-2.0
// What looking for people and faces costs: images of the recordings below the folder
// ENGRAM_RECORDINGS (*.mp4), or of a drawn scene of 768 x 432. Time is processor time of all
// threads.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>

#include "datasets/drawn_scene.h"
#include "datasets/media/video_reader.h"
#include "ltm/redaction/redactor.h"

namespace engram::ltm {
namespace {

constexpr size_t kSeenImages = 12;
constexpr size_t kSeenEvery = 40;

std::vector<idf::NdArray> seen_in_videos() {
  std::vector<idf::NdArray> images;
  const char* folder = std::getenv("ENGRAM_RECORDINGS");
  if (folder == nullptr || !std::filesystem::is_directory(folder)) return images;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".mp4") continue;
    auto video = datasets::VideoReader::open(entry.path(), {});
    for (size_t i = 0; video.ok() && i < kSeenImages * kSeenEvery; ++i) {
      auto frame = video->next();
      if (!frame.ok() || !*frame) break;
      if (i % kSeenEvery == 0) images.push_back((*frame)->image);
    }
  }
  return images;
}

const std::vector<idf::NdArray>& seen_images() {
  static const auto all = [] {
    auto images = seen_in_videos();
    if (!images.empty()) return images;
    const auto scene =
        datasets::Scene::create({.width = 768, .height = 432, .seconds = 40, .rate_hz = 15})
            .value();
    for (size_t i = 0; i < kSeenImages; ++i) images.push_back(scene.render(i * kSeenEvery)->image);
    return images;
  }();
  return all;
}

/// One image of a commit.
void redact_images(benchmark::State& state, const DetectorOptions& detector) {
  const auto redactor =
      Redactor::create({{EntityPattern(), RedactionOptions{.detector = detector}}}).value();
  const auto& images = seen_images();
  size_t next = 0;
  for (auto _ : state) {
    Snapshot snapshot{*MemoryId::parse("Vision/RGB/head/cam"), time_from_ns(int64_t(next)), {}};
    snapshot.instances.push_back({images[next++ % images.size()], {}});
    if (redactor->redact(snapshot).is_dropped()) std::abort();
  }
  state.counters["images"] = static_cast<double>(images.size());
  state.counters["height"] = static_cast<double>(images[0].shape()[0]);
  state.counters["width"] = static_cast<double>(images[0].shape()[1]);
  state.counters["boxes"] = static_cast<double>(redactor->counters().boxes) /
                            static_cast<double>(redactor->counters().images);
}

void RedactPeople(benchmark::State& state) {
  redact_images(state, PeopleDetector::Options());
}
BENCHMARK(RedactPeople)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

void RedactFaces(benchmark::State& state) {
  redact_images(state, FacesDetector::Options());
}
BENCHMARK(RedactFaces)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::ltm
