// SPDX-License-Identifier: Apache-2.0
// What the latents of image_latents.py really take: bytes that decode to them again.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <vector>

#include "encoders/coding/latent_sequence.h"

namespace {

using engram::encoders::LatentGrid;
using engram::encoders::LatentModel;
using engram::encoders::LatentSequenceCodec;
using Sequence = std::vector<int32_t>;

constexpr int32_t kMost = 1 << 20;

struct Trial {
  std::vector<LatentGrid> grids;
  std::vector<Sequence> recordings;
  size_t rows = 0;
  size_t latents = 0;  ///< Of a row.
};

std::optional<Trial> read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  const auto next = [&file] {
    int32_t value = -1;
    file.read(reinterpret_cast<char*>(&value), sizeof(value));
    return value;
  };
  const int32_t rows = next(), recordings = next();
  if (!file || rows < 1 || rows > kMost || recordings < 1 || recordings > rows) return {};
  std::vector<int32_t> starts;
  for (int32_t i = 0; i < recordings; ++i) starts.push_back(next());
  starts.push_back(rows);
  Trial trial;
  trial.rows = static_cast<size_t>(rows);
  for (int i = 0; i < 2; ++i) {
    const int32_t channels = next(), height = next(), width = next();
    if (std::min({channels, height, width}) < 1 || std::max({channels, height, width}) > 1024)
      return {};
    trial.grids.push_back({channels, height, width});
    trial.latents += trial.grids.back().count();
  }
  for (size_t i = 0; i + 1 < starts.size(); ++i) {
    if (starts[i + 1] <= starts[i]) return {};
    Sequence sequence(static_cast<size_t>(starts[i + 1] - starts[i]) * trial.latents);
    file.read(reinterpret_cast<char*>(sequence.data()),
              static_cast<std::streamsize>(sequence.size() * sizeof(int32_t)));
    trial.recordings.push_back(std::move(sequence));
  }
  return file ? std::optional(std::move(trial)) : std::nullopt;
}

std::vector<Sequence> blocks_of(const Trial& trial, size_t rows) {
  std::vector<Sequence> blocks;
  for (const Sequence& recording : trial.recordings)
    for (size_t at = 0; at < recording.size(); at += rows * trial.latents)
      blocks.emplace_back(
          recording.begin() + static_cast<ptrdiff_t>(at),
          recording.begin() +
              static_cast<ptrdiff_t>(std::min(recording.size(), at + rows * trial.latents)));
  return blocks;
}

/// False where a block does not decode to what it was made of.
bool print_row(const Trial& trial, size_t rows, const std::string& name) {
  const auto blocks = blocks_of(trial, rows);
  const LatentSequenceCodec codec(LatentModel::train(trial.grids, blocks));
  size_t bytes = 0;
  double seconds = 0;
  for (const Sequence& block : blocks) {
    const auto coded = codec.encode(block);
    bytes += coded.size();
    const auto begin = std::chrono::steady_clock::now();
    const auto decoded = codec.decode(coded, block.size() / trial.latents);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!decoded.ok() || *decoded != block) return false;
  }
  const auto each = static_cast<double>(trial.rows);
  fmt::print("| {:<14} | {:<15.1f} | {:<11} | {:<15.2f} |\n", name,
             static_cast<double>(bytes) / each, codec.model().to_bytes().size(),
             seconds * 1000 / each);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const auto trial = argc == 2 ? read(argv[1]) : std::nullopt;
  if (!trial) {
    fmt::print(stderr, "latent_bytes: needs one file that image_latents.py wrote\n");
    return 2;
  }
  fmt::print("{} rows of {} latents in {} recordings\n\n", trial->rows, trial->latents,
             trial->recordings.size());
  fmt::print("| rows per block | bytes per image | model bytes | ms per row, out |\n");
  fmt::print("|----------------|-----------------|-------------|-----------------|\n");
  const bool is_right = print_row(*trial, trial->rows, "whole") && print_row(*trial, 32, "32") &&
                        print_row(*trial, 10, "10") && print_row(*trial, 1, "1");
  if (!is_right) fmt::print(stderr, "latent_bytes: a block decodes to something else\n");
  return is_right ? 0 : 1;
}
