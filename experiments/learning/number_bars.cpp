// SPDX-License-Identifier: Apache-2.0
// Measures the size of joint positions within an error bound: our coder with blocks of several
// lengths, on recordings it learned from and on recordings it never saw, and general compressors.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <optional>

#include "encoders/coding/number_codec.h"
#include "encoders/coding/number_training.h"
#include "learning/number_measure.h"
#include "store/report.h"
#include "store/store_measure.h"

namespace engram::experiments {
namespace {

constexpr double kBar = 0.40;  // bytes per value

struct Arguments {
  std::filesystem::path folder;
  double bound = 1e-3;
  size_t stride = 6;
  std::string json;
};

struct Figures {
  double bytes = 0, values = 0, model_bytes = 0, largest_error = 0;
  double encode_seconds = 0, decode_seconds = 0;

  [[nodiscard]] double per_value() const { return bytes / values; }
  [[nodiscard]] double with_model(double count) const { return per_value() + model_bytes / count; }
};

using Recordings = std::vector<NumberRecording>;

/// A bound of zero keeps every bit of float32.
std::vector<encoders::NumberField> fields_of(const Recordings& recordings, double bound) {
  using enum encoders::NumberKind;
  return {{bound > 0 ? kBounded : kExactFloat, static_cast<uint32_t>(recordings[0].columns.size()),
           bound}};
}

Recordings as_floats(Recordings recordings) {
  for (NumberRecording& recording : recordings)
    for (double& value : recording.rows) value = static_cast<double>(static_cast<float>(value));
  return recordings;
}

/// Encodes one recording in blocks with a model that was saved and loaded, and decodes it again.
Status code(const std::vector<std::byte>& model_bytes, const NumberRecording& recording,
            size_t block_rows, double bound, Figures& figures) {
  ENGRAM_ASSIGN_OR_RETURN(auto model, encoders::NumberModel::from_bytes(model_bytes));
  const encoders::NumberCodec codec(std::move(model));
  const size_t width = recording.columns.size();
  const size_t step = (block_rows == 0 ? recording.count() : block_rows) * width;
  for (size_t at = 0; at < recording.rows.size(); at += step) {
    const auto rows =
        std::span(recording.rows).subspan(at).first(std::min(step, recording.rows.size() - at));
    Stopwatch watch;
    const auto block = codec.encode(rows);
    figures.encode_seconds += watch.restart();
    ENGRAM_ASSIGN_OR_RETURN(const auto decoded, codec.decode(block, rows.size() / width));
    figures.decode_seconds += watch.restart();
    figures.bytes += static_cast<double>(block.size());
    figures.values += static_cast<double>(rows.size());
    ENGRAM_ASSIGN_OR_RETURN(const double error,
                            largest_error(recording.name, rows, decoded, bound));
    figures.largest_error = std::max(figures.largest_error, error);
  }
  return {};
}

Result<std::vector<std::byte>> train(const Recordings& recordings, std::optional<size_t> left_out,
                                     size_t block_rows, double bound) {
  std::vector<std::vector<double>> rows;
  for (size_t i = 0; i < recordings.size(); ++i)
    if (i != left_out) rows.push_back(recordings[i].rows);
  encoders::NumberTraining options;
  options.block_rows = block_rows;
  ENGRAM_ASSIGN_OR_RETURN(
      const auto model, encoders::train_number_model(fields_of(recordings, bound), rows, options));
  return model.to_bytes();
}

Result<Figures> in_sample(const Recordings& recordings, size_t block_rows, double bound) {
  ENGRAM_ASSIGN_OR_RETURN(const auto model, train(recordings, std::nullopt, block_rows, bound));
  Figures figures;
  figures.model_bytes = static_cast<double>(model.size());
  for (const NumberRecording& recording : recordings)
    ENGRAM_RETURN_IF_ERROR(code(model, recording, block_rows, bound, figures));
  return figures;
}

Result<Figures> unseen(const Recordings& recordings, size_t block_rows, double bound,
                       std::vector<double>& folds) {
  Figures figures;
  for (size_t i = 0; i < recordings.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto model, train(recordings, i, block_rows, bound));
    const double before = figures.bytes;
    ENGRAM_RETURN_IF_ERROR(code(model, recordings[i], block_rows, bound, figures));
    folds.push_back((figures.bytes - before) / static_cast<double>(recordings[i].rows.size()));
    figures.model_bytes +=
        static_cast<double>(model.size()) / static_cast<double>(recordings.size());
  }
  return figures;
}

/// Measures whole recordings with a model that knows only its fields.
Result<Figures> with_nothing_learned(const Recordings& recordings, double bound) {
  ENGRAM_ASSIGN_OR_RETURN(const auto model,
                          encoders::NumberModel::create(fields_of(recordings, bound)));
  const std::vector<std::byte> bytes = model.to_bytes();
  Figures figures;
  figures.model_bytes = static_cast<double>(bytes.size());
  for (const NumberRecording& recording : recordings)
    ENGRAM_RETURN_IF_ERROR(code(bytes, recording, 0, bound, figures));
  return figures;
}

Status add_rivals(const Recordings& recordings, double bound, TextTable& table,
                  nlohmann::json& json) {
  double values = 0;
  for (const NumberRecording& recording : recordings)
    values += static_cast<double>(recording.rows.size());
  ENGRAM_ASSIGN_OR_RETURN(const RivalBytes rivals, rival_bytes(recordings, bound));
  const auto add = [&](const std::string& name, double bytes) {
    table.add({name, "whole", fmt::format("{:.3f}", bytes / values), "-", "-", "-", "-"});
    json["rivals"][name] = bytes / values;
  };
  add("float32, zstd 19", rivals.floats);
  add("differences of steps, zstd 19", rivals.differences);
  add("steps, compress_column", rivals.steps);
  return {};
}

void add_row(const std::string& name, size_t block_rows, const Figures& figures, double width,
             TextTable& table, nlohmann::json& json) {
  const std::string block = block_rows == 0 ? "whole" : std::to_string(block_rows);
  table.add({name, block, fmt::format("{:.4f}", figures.per_value()),
             fmt::format("{:.0f}", figures.model_bytes),
             fmt::format("{:.3f} / {:.3f} / {:.3f}", figures.with_model(figures.values),
                         figures.with_model(3000 * width), figures.with_model(30000 * width)),
             fmt::format("{:.6f}", figures.largest_error),
             fmt::format("{:.1f} / {:.1f}", 1e6 * figures.encode_seconds / figures.values,
                         1e6 * figures.decode_seconds / figures.values)});
  json["ours"].push_back({{"name", name},
                          {"block_rows", block_rows},
                          {"bytes_per_value", figures.per_value()},
                          {"model_bytes", figures.model_bytes},
                          {"largest_error", figures.largest_error}});
}

/// The sizes of whole recordings. Unit: bytes per value.
struct Judged {
  double own = 0;
  std::vector<double> left_out;  ///< Each recording with a model of the others; empty for one.
  double left_out_all = 0;
};

/// The bar is for recordings that the model never saw.
void print_verdict(const Judged& judged) {
  fmt::print("bar, whole recordings: at most {:.2f} bytes per value\n", kBar);
  fmt::print("  what it learned from: {:.4f} {}\n", judged.own, verdict(judged.own <= kBar));
  if (judged.left_out.empty()) {
    fmt::print("  left out: not judged, found one recording, needs two\n");
    return;
  }
  fmt::print("  left out: {:.4f} {}; each:", judged.left_out_all,
             verdict(judged.left_out_all <= kBar));
  for (const double fold : judged.left_out) fmt::print(" {:.4f}", fold);
  fmt::print("\n");
}

/// Adds the rows of all block lengths.
Result<Judged> add_ours(const Recordings& recordings, double bound, TextTable& table,
                        nlohmann::json& json) {
  const auto width = static_cast<double>(recordings[0].columns.size());
  Judged judged;
  for (const size_t block_rows : {0, 30, 10, 1}) {
    ENGRAM_ASSIGN_OR_RETURN(const Figures own, in_sample(recordings, block_rows, bound));
    add_row("ours, what it learned from", block_rows, own, width, table, json);
    if (block_rows == 0) judged.own = own.per_value();
    if (recordings.size() < 2) continue;
    std::vector<double> folds;
    ENGRAM_ASSIGN_OR_RETURN(const Figures left_out, unseen(recordings, block_rows, bound, folds));
    add_row("ours, one recording left out", block_rows, left_out, width, table, json);
    if (block_rows == 0) judged = {judged.own, folds, left_out.per_value()};
  }
  if (recordings.size() > 1) {
    std::vector<double> folds;
    ENGRAM_ASSIGN_OR_RETURN(const Figures exact, unseen(as_floats(recordings), 0, 0, folds));
    add_row("ours, every bit of float32, one recording left out", 0, exact, width, table, json);
  }
  ENGRAM_ASSIGN_OR_RETURN(const Figures untrained, with_nothing_learned(recordings, bound));
  add_row("ours, nothing learned", 0, untrained, width, table, json);
  return judged;
}

Status measure(const std::vector<std::string>& prefixes, const Arguments& arguments,
               nlohmann::json& json) {
  ENGRAM_ASSIGN_OR_RETURN(const Recordings recordings,
                          read_numbers(arguments.folder, prefixes, arguments.stride));
  size_t rows = 0;
  for (const NumberRecording& recording : recordings) rows += recording.count();
  fmt::print("\n{} numbers, {} rows in {} recordings, bound {}\n\n", recordings[0].columns.size(),
             rows, recordings.size(), arguments.bound);
  TextTable table({"what", "rows per block", "bytes per value", "model bytes",
                   "with model: these, 3,000, 30,000 rows", "largest error",
                   "us per value, in / out"});
  ENGRAM_ASSIGN_OR_RETURN(const Judged judged, add_ours(recordings, arguments.bound, table, json));
  ENGRAM_RETURN_IF_ERROR(add_rivals(recordings, arguments.bound, table, json));
  fmt::print("{}", table.to_string());
  print_verdict(judged);
  return {};
}

Status run(const Arguments& arguments) {
  nlohmann::json json;
  ENGRAM_RETURN_IF_ERROR(measure({"state."}, arguments, json["state"]));
  ENGRAM_RETURN_IF_ERROR(measure({"action.", "state."}, arguments, json["action_and_state"]));
  return write_json(arguments.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int count, char** values) {
  using namespace engram::experiments;
  Arguments arguments;
  arguments.folder = recordings_folder();
  CLI::App app("What joint positions cost within an error bound");
  app.add_option("--recordings", arguments.folder, "folder with CSV files (ENGRAM_RECORDINGS)");
  app.add_option("--bound", arguments.bound, "largest error");
  app.add_option("--stride", arguments.stride, "every so many rows of a table")
      ->check(CLI::PositiveNumber);
  app.add_option("--json", arguments.json, "write figures there");
  CLI11_PARSE(app, count, values);
  return exit_code("number_bars", run(arguments));
}
