// SPDX-License-Identifier: Apache-2.0
// Measures how well joint positions are predicted from their past. Each recording is left out in
// turn: the others are known before it, and its rows come one by one.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "learning/number_data.h"
#include "ltm/prediction/series_predictor.h"
#include "store/report.h"
#include "store/store_measure.h"

namespace engram::experiments {
namespace {

constexpr double kRowsPerSecond = 30;
/// The maximum excess of the choice over the best engine, and its minimum gain over the last value.
constexpr double kMaxAbove = 0.02;
struct Horizon {
  double seconds = 0;
  double min_below = 0;
};
constexpr Horizon kHorizons[] = {{0.2, 0.30}, {0.4, 0.25}, {1.0, 0.10}};

struct Arguments {
  std::filesystem::path folder;
  std::vector<std::string> prefixes{"state."};
  std::vector<std::string> inputs;
  std::string json;
};

Duration seconds(double count) {
  return std::chrono::round<Duration>(std::chrono::duration<double>(count));
}

std::span<const double> row_of(const NumberRecording& recording, size_t row) {
  const size_t width = recording.columns.size();
  return std::span(recording.rows).subspan(row * width, width);
}

/// Columns that are predicted come before those that are only known.
size_t measured_count(const NumberRecording& recording, const Arguments& arguments) {
  return static_cast<size_t>(std::ranges::count_if(recording.columns, [&](const auto& column) {
    return std::ranges::any_of(arguments.prefixes,
                               [&](const auto& prefix) { return column.starts_with(prefix); });
  }));
}

/// Squared errors by engine of the first `measured` numbers; "auto" is the choice.
struct Errors {
  size_t measured = 0;
  std::map<std::string, double> sums;
  double numbers = 0;

  [[nodiscard]] double rmse(const std::string& engine) const {
    return std::sqrt(sums.at(engine) / numbers);
  }
};

Status add_errors(ltm::SeriesPredictor& predictor, const NumberRecording& recording, size_t row,
                  double horizon_s, Errors& errors) {
  const auto then = static_cast<size_t>(std::lround(horizon_s * kRowsPerSecond)) + row;
  if (then >= recording.count()) return {};
  const auto truth = row_of(recording, then).first(errors.measured);
  std::vector<std::string> engines{""};
  for (const auto& record : predictor.records(seconds(horizon_s))) engines.push_back(record.engine);
  for (const std::string& engine : engines) {
    ENGRAM_ASSIGN_OR_RETURN(const auto predicted, predictor.predict(seconds(horizon_s), engine));
    double sum = 0;
    for (size_t i = 0; i < truth.size(); ++i) sum += std::pow(predicted.values[i] - truth[i], 2);
    errors.sums[engine.empty() ? "auto" : engine] += sum;
  }
  errors.numbers += static_cast<double>(truth.size());
  return {};
}

/// Recordings are placed a minute apart, and the left-out one comes last.
Status add_fold(const std::vector<NumberRecording>& recordings, size_t left_out,
                std::vector<Errors>& errors) {
  ltm::NumberSeries series(recordings[left_out].columns.size());
  double start = 0;
  const auto add = [&](const NumberRecording& recording, size_t row) {
    return series.add(Time(seconds(start + static_cast<double>(row) / kRowsPerSecond)),
                      row_of(recording, row));
  };
  for (size_t i = 0; i < recordings.size(); ++i) {
    if (i == left_out) continue;
    for (size_t row = 0; row < recordings[i].count(); ++row)
      ENGRAM_RETURN_IF_ERROR(add(recordings[i], row));
    start += 60 + static_cast<double>(recordings[i].count()) / kRowsPerSecond;
  }
  ltm::SeriesPredictor predictor(series);
  for (size_t row = 0; row < recordings[left_out].count(); ++row) {
    ENGRAM_RETURN_IF_ERROR(add(recordings[left_out], row));
    if (row < 4) continue;  // Engines that fit a line need five rows.
    for (size_t h = 0; h < errors.size(); ++h)
      ENGRAM_RETURN_IF_ERROR(
          add_errors(predictor, recordings[left_out], row, kHorizons[h].seconds, errors[h]));
  }
  return {};
}

void show(const std::vector<Errors>& errors, nlohmann::json& json) {
  std::vector<std::string> head{"RMSE"};
  for (const Horizon& horizon : kHorizons) head.push_back(fmt::format("{} s", horizon.seconds));
  TextTable table(head);
  for (const auto& [engine, sum] : errors.front().sums) {
    std::vector<std::string> cells{engine};
    for (size_t h = 0; h < errors.size(); ++h) {
      const double rmse = errors[h].rmse(engine);
      cells.push_back(fmt::format("{:.4f}", rmse));
      json[engine][fmt::format("{}", kHorizons[h].seconds)] = rmse;
    }
    table.add(cells);
  }
  fmt::print("{}", table.to_string());
  for (size_t h = 0; h < errors.size(); ++h) {
    double best = errors[h].rmse("copy-last");
    for (const auto& [engine, sum] : errors[h].sums)
      if (engine != "auto") best = std::min(best, errors[h].rmse(engine));
    const double below = 1 - errors[h].rmse("auto") / errors[h].rmse("copy-last");
    const double above = errors[h].rmse("auto") / best - 1;
    fmt::print(
        "{} s: {:.1f} % below the last value (needs {:.0f}), {:+.1f} % beside the best engine "
        "(at most {:.0f}): {}\n",
        kHorizons[h].seconds, 100 * below, 100 * kHorizons[h].min_below, 100 * above,
        100 * kMaxAbove, verdict(below >= kHorizons[h].min_below && above <= kMaxAbove));
  }
}

Status run(const Arguments& arguments) {
  std::vector<std::string> prefixes = arguments.prefixes;
  prefixes.insert(prefixes.end(), arguments.inputs.begin(), arguments.inputs.end());
  ENGRAM_ASSIGN_OR_RETURN(const auto recordings, read_numbers(arguments.folder, prefixes, 1));
  const size_t measured = measured_count(recordings[0], arguments);
  std::vector<Errors> errors(std::size(kHorizons), Errors{measured, {}});
  for (size_t left_out = 0; left_out < recordings.size(); ++left_out)
    ENGRAM_RETURN_IF_ERROR(add_fold(recordings, left_out, errors));
  fmt::print("{} numbers of {}, {} recordings, each left out in turn\n\n", measured,
             recordings[0].columns.size(), recordings.size());
  nlohmann::json json;
  show(errors, json);
  return write_json(arguments.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int count, char** values) {
  using namespace engram::experiments;
  Arguments arguments;
  arguments.folder = recordings_folder();
  CLI::App app("How well joint positions are predicted from their past");
  app.add_option("--recordings", arguments.folder, "folder with CSV files (ENGRAM_RECORDINGS)");
  app.add_option("--prefix", arguments.prefixes, "columns that begin so")->capture_default_str();
  app.add_option("--inputs", arguments.inputs, "columns that are known too, and not measured");
  app.add_option("--json", arguments.json, "write figures there");
  CLI11_PARSE(app, count, values);
  return exit_code("prediction_bars", run(arguments));
}
