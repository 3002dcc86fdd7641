// SPDX-License-Identifier: Apache-2.0
// What joint positions cost within an error bound: our coder with blocks of several lengths, on
// what it learned from and on recordings that it never saw, beside general compressors.
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdlib>
#include <optional>

#include "encoders/coding/number_codec.h"
#include "encoders/coding/number_training.h"
#include "learning/number_data.h"
#include "ltm/codec/column_codec.h"
#include "ltm/codec/zstd.h"
#include "store/measure.h"
#include "store/report.h"

namespace engram::experiments {
namespace {

constexpr double kBar = 0.40;  // bytes per value
constexpr int kZstdLevel = 19;

struct Arguments {
  std::string folder;
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

/// Codes one recording in blocks with a model that went through its bytes, and decodes it again.
Status code(const std::vector<std::byte>& model_bytes, const NumberRecording& recording,
            size_t block_rows, Figures& figures) {
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
    for (size_t i = 0; i < rows.size(); ++i)
      figures.largest_error = std::max(figures.largest_error, std::abs(rows[i] - decoded[i]));
  }
  return {};
}

Result<std::vector<std::byte>> train(const Recordings& recordings, std::optional<size_t> left_out,
                                     size_t block_rows, double bound) {
  std::vector<std::vector<double>> rows;
  for (size_t i = 0; i < recordings.size(); ++i)
    if (i != left_out) rows.push_back(recordings[i].rows);
  const auto width = static_cast<uint32_t>(recordings[0].columns.size());
  encoders::NumberTraining options;
  options.block_rows = block_rows;
  ENGRAM_ASSIGN_OR_RETURN(const auto model,
                          encoders::train_number_model(
                              {{encoders::NumberKind::kBounded, width, bound}}, rows, options));
  return model.to_bytes();
}

Result<Figures> in_sample(const Recordings& recordings, size_t block_rows, double bound) {
  ENGRAM_ASSIGN_OR_RETURN(const auto model, train(recordings, std::nullopt, block_rows, bound));
  Figures figures;
  figures.model_bytes = static_cast<double>(model.size());
  for (const NumberRecording& recording : recordings)
    ENGRAM_RETURN_IF_ERROR(code(model, recording, block_rows, figures));
  return figures;
}

Result<Figures> unseen(const Recordings& recordings, size_t block_rows, double bound,
                       std::vector<double>& folds) {
  Figures figures;
  for (size_t i = 0; i < recordings.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto model, train(recordings, i, block_rows, bound));
    const double before = figures.bytes;
    ENGRAM_RETURN_IF_ERROR(code(model, recordings[i], block_rows, figures));
    folds.push_back((figures.bytes - before) / static_cast<double>(recordings[i].rows.size()));
    figures.model_bytes +=
        static_cast<double>(model.size()) / static_cast<double>(recordings.size());
  }
  return figures;
}

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

/// Column by column: steps of twice the bound, or their differences.
std::vector<int16_t> quantised(const NumberRecording& recording, double bound, bool is_delta) {
  std::vector<int16_t> result;
  const size_t width = recording.columns.size();
  for (size_t column = 0; column < width; ++column) {
    long before = 0;
    for (size_t at = column; at < recording.rows.size(); at += width) {
      const long step = std::lround(recording.rows[at] / (2 * bound));
      result.push_back(static_cast<int16_t>(is_delta ? step - before : step));
      before = step;
    }
  }
  return result;
}

void add_rivals(const Recordings& recordings, double bound, TextTable& table,
                nlohmann::json& json) {
  double values = 0, raw = 0, delta = 0, columns = 0;
  for (const NumberRecording& recording : recordings) {
    values += static_cast<double>(recording.rows.size());
    const std::vector<float> floats(recording.rows.begin(), recording.rows.end());
    raw += static_cast<double>(ltm::compress_zstd(bytes_of(floats), kZstdLevel).size());
    const auto differences = quantised(recording, bound, true);
    delta += static_cast<double>(ltm::compress_zstd(bytes_of(differences), kZstdLevel).size());
    const auto steps = quantised(recording, bound, false);
    columns +=
        static_cast<double>(ltm::compress_column(idf::ElementType::kInt16, bytes_of(steps)).size());
  }
  const auto add = [&](const std::string& name, double bytes) {
    table.add({name, "whole", fmt::format("{:.3f}", bytes / values), "-", "-", "-", "-"});
    json["rivals"][name] = bytes / values;
  };
  add("float32, zstd 19", raw);
  add("differences of steps, zstd 19", delta);
  add("steps, compress_column", columns);
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
  const auto width = static_cast<double>(recordings[0].columns.size());
  std::vector<double> folds;
  double best = 0;
  for (const size_t block_rows : {0, 30, 10, 1}) {
    ENGRAM_ASSIGN_OR_RETURN(const Figures own, in_sample(recordings, block_rows, arguments.bound));
    if (block_rows == 0) best = own.per_value();
    add_row("ours, what it learned from", block_rows, own, width, table, json);
    if (recordings.size() < 2) continue;
    std::vector<double> these;
    ENGRAM_ASSIGN_OR_RETURN(const Figures left_out,
                            unseen(recordings, block_rows, arguments.bound, these));
    if (block_rows == 0) folds = these;
    add_row("ours, one recording left out", block_rows, left_out, width, table, json);
  }
  add_rivals(recordings, arguments.bound, table, json);
  fmt::print("{}", table.to_string());
  fmt::print("left out, each recording:");
  for (const double fold : folds) fmt::print(" {:.4f}", fold);
  fmt::print("\nbar: at most {:.2f} bytes per value: {}\n", kBar, verdict(best <= kBar));
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
  const char* folder = std::getenv("ENGRAM_RECORDINGS");
  arguments.folder = folder == nullptr ? "" : folder;
  CLI::App app("What joint positions cost within an error bound");
  app.add_option("--recordings", arguments.folder, "folder with CSV files (ENGRAM_RECORDINGS)");
  app.add_option("--bound", arguments.bound, "largest error");
  app.add_option("--stride", arguments.stride, "every so many rows of a table")
      ->check(CLI::PositiveNumber);
  app.add_option("--json", arguments.json, "write figures there");
  CLI11_PARSE(app, count, values);
  return exit_code("number_bars", run(arguments));
}
