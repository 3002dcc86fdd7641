// SPDX-License-Identifier: Apache-2.0
// Does the recorder keep up with a robot? Measures speed, bytes and memory at full speed, the
// latency of commits at the robot's pace, and compares them with copying and writing the bytes.
#include <algorithm>

#include "store/recorder_limits.h"
#include "store/recorder_run.h"
#include "store/report.h"
#include "store/stream_options.h"

namespace engram::experiments {
namespace {

constexpr double kSpeedBar = 8;       // times real time
constexpr double kBytesBar = 0.40;    // of the raw bytes
constexpr double kCommitBar = 0.005;  // seconds, p99, at the robot's pace

constexpr const char* kRecorder = "preset: recorder\n";
constexpr const char* kFiltered =
    "entities: [{match: .*, filters: [{frequency: {rate: 5Hz}}],"
    " codecs: [{kind: image, codec: png}]}]\n";

struct Arguments {
  StreamOptions stream{.seconds = 40, .dir = "bars/recorder"};
  double paced_seconds = 20;
  int repeats = 3;
};

/// One row of the report: the repetitions of one way to record.
struct Measured {
  RecorderRun run;
  double stream_seconds = 0;
  std::vector<RecorderFigures> repeats;

  [[nodiscard]] double speed(double share) const {
    std::vector<double> values;
    for (const RecorderFigures& it : repeats) values.push_back(it.times_real);
    return quantile(values, share);
  }

  /// The speed that two otherwise idle processors could reach if all work were shared evenly.
  [[nodiscard]] double free_speed() const {
    std::vector<double> values;
    for (const RecorderFigures& it : repeats) values.push_back(2 * stream_seconds / it.cpu_seconds);
    return quantile(values, 0.5);
  }
};

Result<Measured> measure(const RecorderRun& run, const Stream& stream, const Arguments& arguments,
                         int repeats) {
  Measured measured{run, stream.seconds(), {}};
  for (int i = 0; i < repeats; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(
        RecorderFigures figures,
        record_stream(run, stream, std::filesystem::path(arguments.stream.dir) / "store"));
    measured.repeats.push_back(figures);
    fmt::print("{}: {:.2f} times real time, verified\n", run.name, figures.times_real);
    std::fflush(stdout);
  }
  return measured;
}

nlohmann::json to_json(const Measured& measured) {
  nlohmann::json repeats = nlohmann::json::array();
  for (const RecorderFigures& it : measured.repeats)
    repeats.push_back({{"seconds", it.seconds},
                       {"cpu_seconds", it.cpu_seconds},
                       {"times_real", it.times_real},
                       {"raw_bytes", it.raw_bytes},
                       {"disk_bytes", it.disk_bytes},
                       {"snapshots", it.snapshots},
                       {"memory_bytes", it.memory_bytes},
                       {"late_ms", 1e3 * it.late_s},
                       {"commit", experiments::to_json(it.commit)}});
  return {{"name", measured.run.name}, {"pace", measured.run.pace}, {"repeats", repeats}};
}

std::string verdict_of(const Measured& measured) {
  const RecorderFigures& first = measured.repeats.front();
  const double share = static_cast<double>(first.disk_bytes) / static_cast<double>(first.raw_bytes);
  if (measured.run.pace == 0)
    return verdict(measured.speed(0.5) >= kSpeedBar &&
                   (!measured.run.keeps_all || share <= kBytesBar));
  return measured.run.pace == 1 ? verdict(first.commit.p99 < kCommitBar) : "";
}

void print_table(const std::vector<Measured>& rows) {
  TextTable table({"run", "x real time, best", "median", "2 free cores", "MB/s", "% of raw",
                   "memory MB", "commit p50 ms", "p99", "max", "latest start ms", "bar"});
  for (const Measured& row : rows) {
    const RecorderFigures& it = row.repeats.front();
    const double raw = static_cast<double>(it.raw_bytes);
    const double speed = row.speed(0.5);
    const double rate = raw / 1e6 / row.stream_seconds * speed;
    table.add({row.run.name, fmt::format("{:.2f}", row.speed(1)), fmt::format("{:.2f}", speed),
               fmt::format("{:.1f}", row.free_speed()), fmt::format("{:.0f}", rate),
               fmt::format("{:.1f}", 100 * static_cast<double>(it.disk_bytes) / raw),
               fmt::format("{:.0f}", static_cast<double>(it.memory_bytes) / 1e6),
               fmt::format("{:.2f}", 1e3 * it.commit.median),
               fmt::format("{:.2f}", 1e3 * it.commit.p99),
               fmt::format("{:.1f}", 1e3 * it.commit.max), fmt::format("{:.1f}", 1e3 * it.late_s),
               verdict_of(row)});
  }
  fmt::print("\n{}", table.to_string());
}

void print_limits(const Limits& limits, const RecorderFigures& recorder) {
  const double raw = static_cast<double>(recorder.raw_bytes) / 1e6;
  const double stored = static_cast<double>(recorder.disk_bytes) / 1e6;
  fmt::print(
      "\nLimits, once each: copying the stream in memory {:.0f} MB/s ({:.1f} % of the recorder's"
      " time);\nwriting and forcing its {:.0f} stored MB to the disk {:.0f} MB/s ({:.1f} %).\n",
      raw / limits.copy_seconds, 100 * limits.copy_seconds / recorder.seconds, stored,
      stored / limits.write_seconds, 100 * limits.write_seconds / recorder.seconds);
}

Status run(const Arguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(StreamSource source, load_stream_source(arguments.stream.frames));
  const Stream paced(source, arguments.paced_seconds);
  const Stream stream(std::move(source), arguments.stream.seconds);
  fmt::print("stream: {}; {:.0f} s, {:.3f} MB/s raw\n", stream.description(), stream.seconds(),
             static_cast<double>(stream.raw_bytes()) / 1e6 / stream.seconds());
  std::vector<Measured> rows;
  const std::vector<RecorderRun> unpaced{{"recorder", kRecorder, true, 0},
                                         {"recorder, coding", kRecorder, true, 0, true},
                                         {"5 Hz and PNG", kFiltered, false, 0}};
  for (const RecorderRun& it : unpaced) {
    ENGRAM_ASSIGN_OR_RETURN(Measured row, measure(it, stream, arguments, arguments.repeats));
    rows.push_back(std::move(row));
  }
  ENGRAM_ASSIGN_OR_RETURN(Measured slow,
                          measure({"recorder, 1x", kRecorder, true, 1}, paced, arguments, 1));
  rows.push_back(std::move(slow));
  ENGRAM_ASSIGN_OR_RETURN(
      Measured coding,
      measure({"recorder, 1x, coding", kRecorder, true, 1, true}, paced, arguments, 1));
  rows.push_back(std::move(coding));
  ENGRAM_ASSIGN_OR_RETURN(Measured fast,
                          measure({"recorder, 8x", kRecorder, true, 8}, stream, arguments, 1));
  rows.push_back(std::move(fast));
  const RecorderFigures& first = rows.front().repeats.front();
  ENGRAM_ASSIGN_OR_RETURN(const Limits limits,
                          measure_limits(stream, first.disk_bytes, arguments.stream.dir));
  print_table(rows);
  print_limits(limits, first);
  nlohmann::json json{{"stream", stream.description()},
                      {"copy_seconds", limits.copy_seconds},
                      {"write_seconds", limits.write_seconds}};
  for (const Measured& row : rows) json["runs"].push_back(to_json(row));
  return write_json(arguments.stream.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  engram::experiments::Arguments arguments;
  CLI::App app(
      "Measures the recorder on a robot's stream. ENGRAM_RECORDINGS names a folder of"
      " videos; without it a scene is rendered.");
  arguments.stream.add_to(app);
  engram::experiments::add_seconds(app, "--paced-seconds", arguments.paced_seconds,
                                   "length at the robot's pace");
  app.add_option("--repeats", arguments.repeats, "of what goes as fast as it can")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return engram::experiments::exit_code("recorder_bars", engram::experiments::run(arguments));
}
