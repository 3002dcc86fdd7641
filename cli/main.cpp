// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "cli/command.h"
#include "cli/help_texts.h"
#include "cli/interrupt.h"
#include "cli/learning_environment.h"
#include "ltm/core/log.h"

namespace engram::cli {

namespace {

constexpr const char* kMainFooter = R"(Examples:
  engram simulate scene --video scene.mp4 --table scene.csv
  engram import --video scene.mp4 --table scene.csv --entity Vision/RGB/head/cam \
      --state-entity RobotState/Proprioception/robot/joints --rate 5 robot.engram
  engram info robot.engram
  engram consolidate robot.engram --budget 2m
  engram augment robot.engram --out changed.engram
  engram query robot.engram 'Vision/RGB/head/cam @ latest:3' --save answers
  engram query robot.engram 'Vision/RGB/head/cam @ +200ms'
  engram ls robot.engram Vision/RGB/head/cam
  engram export robot.engram 'Vision @ all' --to mp4 -o videos
  engram models robot.engram
  engram eval robot.engram
  engram predict robot.engram Vision/RGB/head/cam --compare --picture predict.png
  engram crossval robot.engram --entity Vision/RGB/head/cam --budget 5m
  engram forget robot.engram --config robot.yaml --dry-run
  engram compact robot.engram
  engram idf generate kitchen.xml --cpp generated
  engram check robot.engram
  engram serve robot.engram
  engram commit Objects/Things/kitchen/cup --data '{"height": 0.11}'
  engram watch Vision Objects

Results go to stdout, messages and progress to stderr.
Exit codes: 0 done, 1 failed, 2 wrong usage or configuration, 3 done but with data loss.)";

ExitCode run(int argc, char** argv) {
  CLI::App app{"Engram: a deep episodic memory for robots"};
  app.name("engram");
  app.footer(kMainFooter);
  app.require_subcommand(1);
  app.set_version_flag("--version", "engram " ENGRAM_VERSION);
  bool is_quiet = false;
  app.add_flag("-q,--quiet", is_quiet, "Only errors on stderr")->each([](const std::string&) {
    log::set_level(log::Level::kError);
  });
  auto exit_code = ExitCode::kDone;
  add_import_command(app, exit_code);
  add_info_command(app, exit_code);
  add_augment_command(app, exit_code);
  add_consolidate_command(app, exit_code);
  add_models_command(app, exit_code);
  add_crossval_command(app, exit_code);
  add_ls_command(app, exit_code);
  add_query_command(app, exit_code);
  add_export_command(app, exit_code);
  add_eval_command(app, exit_code);
  add_predict_command(app, exit_code);
  add_forget_command(app, exit_code);
  add_compact_command(app, exit_code);
  add_simulate_command(app, exit_code);
  add_idf_command(app, exit_code);
  add_server_commands(app, exit_code);
  add_check_command(app, exit_code);
  add_recover_command(app, exit_code);
  // Called by the build, for the launcher.
  if (argc == 3 && std::string_view(argv[1]) == "--write-help-texts")
    return done_or_failed(write_help_texts(app, argv[2]));
  return run_command(app, argc, argv, exit_code);
}

}  // namespace

}  // namespace engram::cli

int main(int argc, char** argv) {
  if (engram::cli::is_learning(argc, argv)) engram::cli::prepare_to_learn(argv);
  engram::cli::watch_for_interrupts();
  return engram::cli::exit_code_of([&] { return engram::cli::run(argc, argv); });
}
