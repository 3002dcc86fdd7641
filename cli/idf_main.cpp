// SPDX-License-Identifier: Apache-2.0
// `engram idf` as a program of its own. Builds use it to generate code, without the libraries that
// learn.
#include "cli/command.h"

namespace engram::cli {

namespace {

ExitCode run(int argc, char** argv) {
  CLI::App app{"Engram: types and values of the Interpretable Data Format"};
  app.name("engram_idf");
  app.set_version_flag("--version", "engram " ENGRAM_VERSION);
  auto exit_code = ExitCode::kDone;
  add_idf_commands(app, exit_code);
  return run_command(app, argc, argv, exit_code);
}

}  // namespace

}  // namespace engram::cli

int main(int argc, char** argv) {
  return engram::cli::exit_code_of([&] { return engram::cli::run(argc, argv); });
}
