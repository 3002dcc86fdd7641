// SPDX-License-Identifier: Apache-2.0
// Bytes and speed of every codec: images of the recordings below the folder ENGRAM_RECORDINGS
// (*.mp4 and *.csv), or of a rendered scene. docs/codecs.md has the table.
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>

#include "datasets/drawn_scene.h"
#include "datasets/media/table.h"
#include "datasets/media/video_reader.h"
#include "ltm/codec/codec.h"
#include "ltm/codec/column_codec.h"
#include "ltm/codec/group_codec.h"
#include "ltm/codec/zstd.h"
#include "ltm/codec/zstd_dictionary.h"
#include "ltm/idf/binary.h"

namespace engram::ltm {
namespace {

using Images = std::vector<idf::NdArray>;
using Column = std::vector<double>;

constexpr size_t kGroup = 30;
constexpr size_t kSkipped = 60;  ///< Images before the group: recordings start at rest.
constexpr size_t kImageStep = 5;

std::vector<std::filesystem::path> recordings(std::string_view extension) {
  const char* folder = std::getenv("ENGRAM_RECORDINGS");
  std::vector<std::filesystem::path> paths;
  if (folder == nullptr || !std::filesystem::is_directory(folder)) return paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == extension) paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

Images group_of_video(const std::filesystem::path& path) {
  Images group;
  auto video = datasets::VideoReader::open(path, {});
  for (size_t i = 0; video.ok() && i < kSkipped + kGroup; ++i) {
    auto frame = video->next();
    if (!frame.ok() || !*frame) break;
    if (i >= kSkipped) group.push_back((*frame)->image);
  }
  return group;
}

Images group_of_scene() {
  const auto scene =
      datasets::Scene::create({.width = 640, .height = 480, .seconds = 8, .rate_hz = 15}).value();
  Images group;
  for (size_t i = 0; i < kGroup; ++i) group.push_back(scene.render(kSkipped + i)->image);
  return group;
}

/// Neighbouring images, some of each recording.
const std::vector<Images>& groups() {
  static const auto all = [] {
    std::vector<Images> made;
    for (const auto& path : recordings(".mp4"))
      if (Images group = group_of_video(path); group.size() == kGroup)
        made.push_back(std::move(group));
    if (made.empty()) made.push_back(group_of_scene());
    return made;
  }();
  return all;
}

const Images& images() {
  static const auto all = [] {
    Images made;
    for (const Images& group : groups())
      for (size_t i = 0; i < group.size(); i += kImageStep) made.push_back(group[i]);
    return made;
  }();
  return all;
}

const std::vector<Column>& columns() {
  static const auto all = [] {
    std::vector<Column> made;
    for (const auto& path : recordings(".csv")) {
      const auto table = datasets::Table::read(path, {});
      if (!table.ok()) continue;
      for (const auto& column : table->columns()) made.push_back(column.values);
    }
    if (!made.empty()) return made;
    for (int c = 0; c < 20; ++c) {
      made.emplace_back();
      for (int i = 0; i < 400; ++i)
        made.back().push_back(std::round(1e5 * std::sin(0.01 * i + c)) / 1e5);
    }
    return made;
  }();
  return all;
}

double squared_error(const idf::NdArray& a, const idf::NdArray& b) {
  double sum = 0;
  for (size_t i = 0; i < a.bytes().size(); ++i) {
    const double difference = a.values<uint8_t>()[i] - b.values<uint8_t>()[i];
    sum += difference * difference;
  }
  return sum / static_cast<double>(a.bytes().size());
}

void report(benchmark::State& state, size_t plain, size_t packed, double mse) {
  state.SetBytesProcessed(static_cast<int64_t>(state.iterations() * plain));
  state.counters["percent"] = 100.0 * static_cast<double>(packed) / static_cast<double>(plain);
  if (mse > 0) state.counters["psnr_db"] = 10 * std::log10(255.0 * 255.0 / mse);
}

void encode_images(benchmark::State& state, const std::string& text) {
  const auto codec = *make_codec(text);
  const Images& loaded = images();  // Before the clock runs.
  size_t plain = 0, packed = 0;
  double mse = 0;
  for (auto _ : state) {
    plain = packed = 0;
    for (const auto& image : loaded) {
      packed += codec->encode(image)->size();
      plain += image.bytes().size();
    }
  }
  if (!codec->is_lossless())
    for (const auto& image : images())
      mse +=
          squared_error(image, *codec->decode(*codec->encode(image), image.type(), image.shape())) /
          static_cast<double>(images().size());
  report(state, plain, packed, mse);
}

void decode_images(benchmark::State& state, const std::string& text) {
  const auto codec = *make_codec(text);
  std::vector<std::vector<std::byte>> all;
  size_t plain = 0, packed = 0;
  for (const auto& image : images()) {
    all.push_back(*codec->encode(image));
    plain += image.bytes().size();
    packed += all.back().size();
  }
  for (auto _ : state)
    for (const auto& bytes : all)
      benchmark::DoNotOptimize(codec->decode(bytes, images()[0].type(), images()[0].shape()));
  report(state, plain, packed, 0);
}

void encode_groups(benchmark::State& state, const std::string& text) {
  const auto codec = make_group_codec(text);
  if (!codec.ok()) return state.SkipWithError(codec.status().message().c_str());
  const std::vector<Images>& loaded = groups();  // Before the clock runs.
  size_t plain = 0, packed = 0;
  double mse = 0;
  std::vector<std::byte> bytes;
  for (auto _ : state) {
    plain = packed = 0;
    for (const Images& group : loaded) {
      bytes = *(*codec)->encode(group);
      packed += bytes.size();
      plain += group.size() * group[0].bytes().size();
    }
  }
  const Images& last = groups().back();
  const auto decoded = *(*codec)->decode(bytes, last[0].type(), last[0].shape(), last.size());
  for (size_t i = 0; i < last.size(); ++i)
    mse += squared_error(last[i], decoded[i]) / static_cast<double>(last.size());
  report(state, plain, packed, mse);
}

void decode_groups(benchmark::State& state, const std::string& text) {
  const auto codec = make_group_codec(text);
  if (!codec.ok()) return state.SkipWithError(codec.status().message().c_str());
  const Images& group = groups().back();
  const auto bytes = *(*codec)->encode(group);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        (*codec)->decode(bytes, group[0].type(), group[0].shape(), group.size()));
  report(state, group.size() * group[0].bytes().size(), bytes.size(), 0);
}

void compress_columns(benchmark::State& state, const std::string& how) {
  const std::vector<Column>& loaded = columns();  // Before the clock runs.
  size_t plain = 0, packed = 0;
  for (auto _ : state) {
    plain = packed = 0;
    for (const Column& column : loaded) {
      const auto bytes = std::as_bytes(std::span(column));
      packed += how == "column" ? compress_column(idf::ElementType::kFloat64, bytes).size()
                                : compress_zstd(bytes).size();
      plain += bytes.size();
    }
  }
  report(state, plain, packed, 0);
}

/// IDF values of a small struct: 33 bytes each.
std::vector<Buffer> small_values() {
  std::vector<Buffer> values;
  for (int i = 0; i < 12'800; ++i)
    values.push_back(Buffer::take(
        *idf::encode(idf::Dict{{"value", static_cast<int32_t>(i % 97)}, {"moment", 0.01 * i}})));
  return values;
}

void compress_values(benchmark::State& state, const std::string& how) {
  const auto values = small_values();
  const auto dictionary = *ZstdDictionary::train({values.data(), 2000}, {});
  size_t packed = 0;
  for (auto _ : state) {
    packed = 0;
    std::vector<std::byte> block;
    for (size_t i = 0; i < values.size(); ++i) {
      const auto bytes = values[i].bytes();
      if (how == "plain") packed += compress_zstd(bytes).size();
      if (how == "dictionary") packed += dictionary.compress(bytes).size();
      if (how != "blocks of 128") continue;
      block.insert(block.end(), bytes.begin(), bytes.end());
      if (i % 128 != 127) continue;
      packed += compress_zstd(block).size();
      block.clear();
    }
  }
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * values.size()));
  state.counters["bytes_each"] = static_cast<double>(packed) / static_cast<double>(values.size());
  state.counters["plain_each"] = static_cast<double>(values[0].size());
}

template <typename F>
void add(const std::string& name, F function, const std::string& text) {
  benchmark::RegisterBenchmark((name + "/" + text).c_str(), [=](benchmark::State& state) {
    function(state, text);
  })->Unit(benchmark::kMillisecond);
}

const bool kAreAdded = [] {
  for (const char* text : {"rowpred", "zstd:1", "zstd", "shuffle", "png", "png:1", "png:6", "ffv1",
                           "jpeg:95", "jpeg:90", "jpeg:75"}) {
    add("codec_encode", encode_images, text);
    add("codec_decode", decode_images, text);
  }
  for (const char* text : {"ffv1", "h264:18", "h264", "h265", "av1"}) {
    add("codec_encode_group", encode_groups, text);
    add("codec_decode_group", decode_groups, text);
  }
  for (const char* how : {"column", "zstd"}) add("codec_columns", compress_columns, how);
  for (const char* how : {"plain", "dictionary", "blocks of 128"})
    add("codec_values", compress_values, how);
  return true;
}();

}  // namespace
}  // namespace engram::ltm
