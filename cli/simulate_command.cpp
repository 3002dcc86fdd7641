// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/progress_line.h"
#include "cli/simulate_kitchen.h"
#include "datasets/drawn_scene.h"

namespace engram::cli {

namespace {

constexpr const char* kFooterOfAll = R"(Examples:
  engram simulate scene --video scene.mp4 --table scene.csv
  engram simulate kitchen kitchen.engram --seed 3)";

constexpr const char* kSimulateFooter = R"(Example:
  engram simulate scene --seconds 60 --seed 1 --video scene.mp4 --table scene.csv)";

struct SceneArguments {
  datasets::SceneOptions options;
  std::string video;
  std::string table;
};

ExitCode run(const SceneArguments& arguments) {
  if (const Status status = arguments.options.validate(); !status.ok()) return wrong_usage(status);
  ProgressLine progress;
  const Status status =
      datasets::write_scene(arguments.options, arguments.video, arguments.table, progress.sink());
  progress.finish();
  if (!status.ok()) return fail(status);
  print(arguments.video + "\n" + arguments.table);
  return ExitCode::kDone;
}

}  // namespace

void add_simulate_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<SceneArguments>();
  CLI::App* simulate = app.add_subcommand("simulate", "Make recordings without a robot");
  simulate->require_subcommand(1);
  simulate->footer(kFooterOfAll);
  CLI::App* scene =
      simulate->add_subcommand("scene", "Draw an arm that picks and places, before a still room");
  scene->footer(kSimulateFooter);
  scene->add_option("--video", arguments->video, "Video to write, MP4")->required();
  scene->add_option("--table", arguments->table, "Table of joints to write, CSV")->required();
  datasets::SceneOptions& options = arguments->options;
  scene->add_option("--seconds", options.seconds, "Length")->capture_default_str();
  scene->add_option("--rate", options.rate_hz, "Frames per second")->capture_default_str();
  scene->add_option("--width", options.width, "Pixels")->capture_default_str();
  scene->add_option("--height", options.height, "Pixels")->capture_default_str();
  scene->add_option("--noise", options.noise_sigma, "Sensor noise, grey levels")
      ->capture_default_str();
  scene->add_option("--seed", options.seed, "Same seed, same bytes")->capture_default_str();
  scene->callback([arguments, &exit_code] { exit_code = run(*arguments); });
  add_kitchen_command(*simulate, exit_code);
}

}  // namespace engram::cli
