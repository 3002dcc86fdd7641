// SPDX-License-Identifier: Apache-2.0
// What the choices of storage at seal time cost and give: images of the recordings below the folder
// ENGRAM_RECORDINGS (*.mp4), five a second, or of a rendered scene, with 43 numbers each. A record
// run includes sealing; a read is one snapshot at a random place. docs/codecs.md has the table.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>

#include "datasets/drawn_scene.h"
#include "datasets/media/table.h"
#include "datasets/media/video_reader.h"
#include "ltm/recording/recorder.h"
#include "ltm/recording/recording_config.h"
#include "ltm/store/store_reader.h"
#include "tests/ltm/scratch_directory.h"
#include "training/quality/psnr.h"

namespace engram::ltm {
namespace {

using SealImages = std::vector<idf::NdArray>;

constexpr size_t kMaxImages = 400;
constexpr int kNumbers = 43;
constexpr Duration kStep = std::chrono::milliseconds(200);

MemoryId camera() {
  return *MemoryId::parse("Vision/RGB/head/cam");
}

/// Every sixth frame of videos with 30 a second.
void add_video(const std::filesystem::path& path, SealImages& images) {
  auto video = datasets::VideoReader::open(path, {});
  for (size_t i = 0; video.ok() && images.size() < kMaxImages; ++i) {
    auto frame = video->next();
    if (!frame.ok() || !*frame) return;
    if (i % 6 == 0) images.push_back((*frame)->image);
  }
}

const SealImages& seal_images() {
  static const auto all = [] {
    SealImages made;
    std::vector<std::filesystem::path> paths;
    if (const char* folder = std::getenv("ENGRAM_RECORDINGS"))
      for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.path().extension() == ".mp4") paths.push_back(entry.path());
    std::ranges::sort(paths);
    for (const auto& path : paths) add_video(path, made);
    if (!made.empty()) return made;
    const auto scene =
        datasets::Scene::create({.width = 640, .height = 480, .seconds = 20, .rate_hz = 5}).value();
    for (int i = 0; i < 90; ++i) made.push_back(scene.render(i)->image);
    return made;
  }();
  return all;
}

Snapshot snapshot(size_t index) {
  idf::Dict joints;
  for (int i = 0; i < kNumbers; ++i)
    joints.set("joint_" + std::to_string(i),
               std::sin(0.05 * static_cast<double>(index) + static_cast<double>(i)));
  const Time time = time_from_ns(0) + kStep * static_cast<int64_t>(index + 1);
  return {camera(), time, {{idf::Dict{{"image", seal_images()[index]}, {"joints", joints}}, {}}}};
}

/// Records all images into a store that is not there; `codecs` is YAML.
Status record(const std::filesystem::path& store, const std::string& codecs) {
  ENGRAM_ASSIGN_OR_RETURN(
      const auto options,
      parse_recording_config("entities: [{match: .*, codecs: " + codecs + "}]", codecs));
  ENGRAM_ASSIGN_OR_RETURN(auto recorder, Recorder::open(store, options));
  for (size_t i = 0; i < seal_images().size(); ++i)
    ENGRAM_RETURN_IF_ERROR(recorder.commit({{snapshot(i)}}));
  return recorder.close();
}

/// Of the store's images beside those that were recorded.
Result<training::PsnrStatistics> psnr_of(StoreReader& reader) {
  training::PsnrStatistics psnr;
  ENGRAM_ASSIGN_OR_RETURN(const auto* entries, reader.index(camera()));
  for (size_t i = 0; i < entries->size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const Snapshot found, reader.read_recorded(camera(), (*entries)[i]));
    const auto& image = found.instances[0].data.at("image")->get<idf::NdArray>();
    ENGRAM_ASSIGN_OR_RETURN(const double mse, training::image_mse(seal_images()[i], image));
    psnr.add(mse);
  }
  return psnr;
}

void record_all(benchmark::State& state, const std::string& codecs) {
  const ScratchDirectory scratch;
  uint64_t raw = 0;
  for (const idf::NdArray& image : seal_images()) raw += image.bytes().size();
  for (auto _ : state) {
    std::filesystem::remove_all(scratch / "store");
    if (const Status status = record(scratch / "store", codecs); !status.ok())
      return state.SkipWithError(status.to_string().c_str());
  }
  const auto reader = *StoreReader::open(scratch / "store");
  const auto psnr = psnr_of(*reader);
  if (!psnr.ok()) return state.SkipWithError(psnr.status().to_string().c_str());
  state.SetBytesProcessed(static_cast<int64_t>(state.iterations() * raw));
  state.counters["kB_each"] = static_cast<double>(reader->summary(camera())->stored_bytes) / 1000 /
                              static_cast<double>(seal_images().size());
  state.counters["psnr_db"] = psnr->pooled_db();
  state.counters["worst_db"] = psnr->minimum_db();
}

void read_random(benchmark::State& state, const std::string& codecs) {
  const ScratchDirectory scratch;
  if (const Status status = record(scratch / "store", codecs); !status.ok())
    return state.SkipWithError(status.to_string().c_str());
  const auto reader = *StoreReader::open(scratch / "store");
  const auto* entries = *reader->index(camera());
  std::mt19937 random(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        reader->read_recorded(camera(), (*entries)[random() % entries->size()]));
}

void read_in_order(benchmark::State& state, const std::string& codecs) {
  const ScratchDirectory scratch;
  if (const Status status = record(scratch / "store", codecs); !status.ok())
    return state.SkipWithError(status.to_string().c_str());
  const auto reader = *StoreReader::open(scratch / "store");
  const auto* entries = *reader->index(camera());
  size_t next = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(reader->read_recorded(camera(), (*entries)[next++ % entries->size()]));
}

/// The rows of all tables (*.csv) of the recordings, or made-up ones, as values.
const std::vector<idf::Data>& rows() {
  static const auto all = [] {
    std::vector<idf::Data> made;
    std::vector<std::filesystem::path> paths;
    if (const char* folder = std::getenv("ENGRAM_RECORDINGS"))
      for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.path().extension() == ".csv") paths.push_back(entry.path());
    std::ranges::sort(paths);
    for (const auto& path : paths) {
      const auto table = datasets::Table::read(path, {});
      if (!table.ok() || table->columns().empty()) continue;
      for (size_t row = 0; row < table->columns()[0].values.size(); ++row) {
        idf::Dict value;
        for (size_t i = 0; i < table->columns().size(); ++i)
          value.set("column_" + std::to_string(i), table->columns()[i].values[row]);
        made.emplace_back(std::move(value));
      }
    }
    for (int i = 0; made.size() < 1000; ++i) made.push_back(snapshot(0).instances[0].data);
    return made;
  }();
  return all;
}

/// Records the rows ten times over; `value_of` makes the value of a row.
template <typename F>
Status record_rows(const std::filesystem::path& store, const std::string& codecs,
                   const F& value_of) {
  ENGRAM_ASSIGN_OR_RETURN(
      const auto options,
      parse_recording_config("entities: [{match: .*, codecs: " + codecs + "}]", codecs));
  ENGRAM_ASSIGN_OR_RETURN(auto recorder, Recorder::open(store, options));
  for (size_t i = 0; i < 10 * rows().size(); ++i) {
    const Time time = time_from_ns(0) + kStep * static_cast<int64_t>(i + 1);
    ENGRAM_RETURN_IF_ERROR(recorder.commit({{{camera(), time, {{value_of(i), {}}}}}}));
  }
  return recorder.close();
}

void record_numbers(benchmark::State& state, const std::string& codecs) {
  const ScratchDirectory scratch;
  const auto value_of = [](size_t i) { return rows()[i % rows().size()]; };
  for (auto _ : state) {
    std::filesystem::remove_all(scratch / "store");
    if (const Status status = record_rows(scratch / "store", codecs, value_of); !status.ok())
      return state.SkipWithError(status.to_string().c_str());
  }
  const auto reader = *StoreReader::open(scratch / "store");
  const auto summary = *reader->summary(camera());
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * summary.snapshots));
  state.counters["bytes_each"] =
      static_cast<double>(summary.stored_bytes) / static_cast<double>(summary.snapshots);
}

void read_numbers(benchmark::State& state, const std::string& codecs) {
  const ScratchDirectory scratch;
  const auto value_of = [](size_t i) { return rows()[i % rows().size()]; };
  if (const Status status = record_rows(scratch / "store", codecs, value_of); !status.ok())
    return state.SkipWithError(status.to_string().c_str());
  const auto reader = *StoreReader::open(scratch / "store");
  const auto* entries = *reader->index(camera());
  std::mt19937 random(1);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        reader->read_recorded(camera(), (*entries)[random() % entries->size()]));
}

template <typename F>
auto* add_sealing(const std::string& name, F function, const std::string& codec) {
  const std::string codecs = "[{kind: image, codec: \"" + codec + "\"}]";
  return benchmark::RegisterBenchmark((name + "/" + codec).c_str(),
                                      [=](benchmark::State& state) { function(state, codecs); })
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

const bool kSealingIsAdded = [] {
  for (const char* codec :
       {"rowpred", "png", "jpeg", "jpeg:75", "ffv1:group=30", "h264:crf=18,group=10",
        "h264:crf=18,group=30", "h264:crf=23,group=10", "h264:crf=23,group=30",
        "h264:crf=23,group=60", "h265:crf=23,group=30", "h265:crf=26,group=30"})
    add_sealing("seal_record", record_all, codec)->Iterations(1);
  for (const char* codec :
       {"rowpred", "png", "jpeg", "ffv1:group=10", "ffv1:group=30", "h264:crf=23,group=10",
        "h264:crf=23,group=30", "h265:crf=26,group=30"}) {
    add_sealing("seal_read_random", read_random, codec);
    add_sealing("seal_read_in_order", read_in_order, codec);
  }
  for (const char* how : {"none", "columns"}) {
    const std::string codecs = std::string("[{kind: number, codec: ") + how + "}]";
    benchmark::RegisterBenchmark((std::string("seal_record_numbers/") + how).c_str(),
                                 [=](benchmark::State& state) { record_numbers(state, codecs); })
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->Iterations(1);
    benchmark::RegisterBenchmark((std::string("seal_read_numbers/") + how).c_str(),
                                 [=](benchmark::State& state) { read_numbers(state, codecs); })
        ->Unit(benchmark::kMicrosecond);
  }
  return true;
}();

}  // namespace
}  // namespace engram::ltm
