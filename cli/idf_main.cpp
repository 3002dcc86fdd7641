// SPDX-License-Identifier: Apache-2.0
// `engram idf` as a program of its own: what builds need, without the libraries that learn.
#include <exception>

#include "cli/command.h"
#include "ltm/core/log.h"

namespace engram::cli {

namespace {

ExitCode run(int argc, char** argv) {
  CLI::App app{"Engram: types and values of the Interpretable Data Format"};
  app.name("engram_idf");
  app.set_version_flag("--version", "engram " ENGRAM_VERSION);
  auto exit_code = ExitCode::kDone;
  add_idf_commands(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kWrongUsage;
  }
  return exit_code;
}

}  // namespace

}  // namespace engram::cli

int main(int argc, char** argv) {
  try {
    return static_cast<int>(engram::cli::run(argc, argv));
  } catch (const std::exception& error) {
    engram::log::write(engram::log::Level::kError, error.what());
  }
  return static_cast<int>(engram::cli::ExitCode::kFailed);
}
