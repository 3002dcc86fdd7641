// SPDX-License-Identifier: Apache-2.0
#include "learning/latent_trial.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <span>

namespace engram::experiments {

namespace fs = std::filesystem;

namespace {

constexpr int32_t kMaxRows = 1 << 20, kLargestSide = 1024;
constexpr size_t kGrids = 2;

/// Reads the integers of a file. After its end it returns -1.
class IntegerFile {
 public:
  explicit IntegerFile(const fs::path& file) : stream_(file, std::ios::binary) {}

  int32_t next() {
    int32_t value = -1;
    stream_.read(reinterpret_cast<char*>(&value), sizeof(value));
    return stream_ ? value : -1;
  }
  LatentRows next(size_t count) {
    LatentRows values(count);
    stream_.read(reinterpret_cast<char*>(values.data()),
                 static_cast<std::streamsize>(count * sizeof(int32_t)));
    return values;
  }
  [[nodiscard]] bool is_whole() const { return static_cast<bool>(stream_); }
  [[nodiscard]] uint64_t at() { return static_cast<uint64_t>(stream_.tellg()); }

 private:
  std::ifstream stream_;
};

/// Returns the first rows of the recordings and the end of the last one. Empty if they do not
/// increase.
std::vector<int32_t> read_starts(IntegerFile& in) {
  const int32_t rows = in.next(), recordings = in.next();
  if (rows < 1 || rows > kMaxRows || recordings < 1 || recordings > rows) return {};
  std::vector<int32_t> starts;
  for (int32_t i = 0; i < recordings; ++i) starts.push_back(in.next());
  starts.push_back(rows);
  const bool is_rising = std::ranges::is_sorted(starts, std::ranges::less_equal());
  return starts.front() == 0 && is_rising ? starts : std::vector<int32_t>();
}

bool read_grids(IntegerFile& in, LatentTrial& trial) {
  for (size_t i = 0; i < kGrids; ++i) {
    const int32_t channels = in.next(), height = in.next(), width = in.next();
    if (std::min({channels, height, width}) < 1 ||
        std::max({channels, height, width}) > kLargestSide)
      return false;
    trial.grids.push_back({channels, height, width});
    trial.latents += trial.grids.back().count();
  }
  return true;
}

}  // namespace

Result<LatentTrial> read_latent_trial(const fs::path& file) {
  std::error_code error;
  const uint64_t size = fs::file_size(file, error);
  if (error) return not_found("file '{}': {}", file.string(), error.message());
  IntegerFile in(file);
  LatentTrial trial;
  const std::vector<int32_t> starts = read_starts(in);
  if (starts.empty() || !read_grids(in, trial))
    return data_loss("file '{}': {} bytes do not begin as latents do", file.string(), size);
  trial.rows = static_cast<size_t>(starts.back());
  const uint64_t needed = in.at() + trial.rows * trial.latents * sizeof(int32_t);
  if (size != needed)
    return data_loss("file '{}': found {} bytes, its {} rows of {} latents need {}", file.string(),
                     size, trial.rows, trial.latents, needed);
  for (size_t i = 0; i + 1 < starts.size(); ++i)
    trial.recordings.push_back(
        in.next(static_cast<size_t>(starts[i + 1] - starts[i]) * trial.latents));
  if (!in.is_whole()) return unavailable("file '{}': cannot be read", file.string());
  return trial;
}

std::vector<LatentRows> blocks_of(const LatentTrial& trial, size_t rows) {
  std::vector<LatentRows> blocks;
  const size_t step = rows * trial.latents;
  for (const LatentRows& recording : trial.recordings)
    for (size_t at = 0; at < recording.size(); at += step) {
      const auto block = std::span(recording).subspan(at, std::min(step, recording.size() - at));
      blocks.emplace_back(block.begin(), block.end());
    }
  return blocks;
}

}  // namespace engram::experiments
