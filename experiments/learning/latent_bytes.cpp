// SPDX-License-Identifier: Apache-2.0
// Measures the real size of the latents of image_latents.py: bytes that decode to them again.
#include <CLI/CLI.hpp>

#include "encoders/coding/latent_sequence.h"
#include "learning/latent_trial.h"
#include "store/report.h"

namespace engram::experiments {
namespace {

using encoders::LatentModel;
using encoders::LatentSequenceCodec;

/// Encodes all recordings in blocks with a model that was saved and loaded, and decodes them again.
Status add_row(const LatentTrial& trial, size_t rows, const std::string& name, TextTable& table) {
  const auto blocks = blocks_of(trial, rows);
  const auto model_bytes = LatentModel::train(trial.grids, blocks).to_bytes();
  ENGRAM_ASSIGN_OR_RETURN(auto model, LatentModel::from_bytes(model_bytes, trial.grids));
  const LatentSequenceCodec codec(std::move(model));
  size_t bytes = 0;
  double seconds = 0;
  for (const LatentRows& block : blocks) {
    const auto coded = codec.encode(block);
    bytes += coded.size();
    Stopwatch watch;
    ENGRAM_ASSIGN_OR_RETURN(const auto decoded, codec.decode(coded, block.size() / trial.latents));
    seconds += watch.seconds();
    if (decoded != block) return data_loss("a block of {} latents decodes to others", block.size());
  }
  const auto each = static_cast<double>(trial.rows);
  table.add({name, fmt::format("{:.1f}", static_cast<double>(bytes) / each),
             std::to_string(model_bytes.size()),
             fmt::format("{:.1f}", static_cast<double>(bytes + model_bytes.size()) / each),
             fmt::format("{:.2f}", 1e3 * seconds / each)});
  return {};
}

Status run(const std::string& file) {
  ENGRAM_ASSIGN_OR_RETURN(const LatentTrial trial, read_latent_trial(file));
  fmt::print("{} rows of {} latents in {} recordings\n\n", trial.rows, trial.latents,
             trial.recordings.size());
  TextTable table({"rows per block", "bytes per image", "entropy model bytes",
                   "bytes per image with it", "ms per row, out"});
  ENGRAM_RETURN_IF_ERROR(add_row(trial, trial.rows, "whole", table));
  for (const size_t rows : {32, 10, 1})
    ENGRAM_RETURN_IF_ERROR(add_row(trial, rows, std::to_string(rows), table));
  fmt::print("{}", table.to_string());
  return {};
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  std::string file;
  CLI::App app("What image latents take as blocks of consecutive ones");
  app.add_option("file", file, "what image_latents.py wrote")->required();
  CLI11_PARSE(app, argc, argv);
  return engram::experiments::exit_code("latent_bytes", engram::experiments::run(file));
}
