// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>
#include <unistd.h>

#include <sstream>

#include "datasets/lerobot/lerobot_episodes.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::datasets::lerobot {
namespace {

/// A description that has been read gives names of files for any episode.
void fuzz_info(const std::string& text) {
  const auto description = parse_info("root", text);
  if (!description.ok()) return;
  ENGRAM_CHECK(description->rate_hz > 0 && description->chunk_size > 0, "no rate");
  Episode episode;
  episode.index = 1'000'000;
  size_t video = 0;
  for (const Feature& feature : description->features) {
    ENGRAM_CHECK(feature.names.empty() || feature.names.size() == feature.count, "names");
    if (feature.kind != Feature::Kind::kVideo) continue;
    episode.videos.emplace_back();
    ENGRAM_CHECK(!description->video_of(episode, feature, video++).empty(), "no name");
  }
  ENGRAM_CHECK(!description->table_of(episode).empty(), "no name");
}

void fuzz_lines(const std::string& text) {
  std::istringstream lines(text);
  const auto episodes = parse_episode_lines("episodes.jsonl", lines);
  if (!episodes.ok()) return;
  for (const Episode& episode : *episodes)
    ENGRAM_CHECK(episode.index >= 0 && episode.length >= 0, "negative");
}

void fuzz_rows(const std::string& text) {
  const int file = ::memfd_create("fuzz", 0);
  ENGRAM_CHECK(
      file >= 0 && ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()),
      "no file");
  Description description;
  Feature& feature = description.features.emplace_back();
  feature.key = "cam";
  feature.kind = Feature::Kind::kVideo;
  auto rows = RowTable::open_csv("/", fmt::format("/proc/self/fd/{}", file));
  if (rows.ok()) {
    const auto episodes = parse_episode_rows(description, *rows);
    if (episodes.ok())
      for (const Episode& episode : *episodes)
        ENGRAM_CHECK(episode.videos.size() == 1 && episode.videos[0].from <= episode.videos[0].to,
                     "parts of videos");
  }
  ::close(file);
}

}  // namespace
}  // namespace engram::datasets::lerobot

/// The first byte says which file of a data set the rest is.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram::datasets::lerobot;
  if (size == 0) return 0;
  const std::string text(engram::fuzzed_text(data + 1, size - 1));
  switch (data[0] % 3) {
    case 0:
      fuzz_info(text);
      break;
    case 1:
      fuzz_lines(text);
      break;
    default:
      fuzz_rows(text);
  }
  return 0;
}
