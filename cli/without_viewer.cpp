// SPDX-License-Identifier: Apache-2.0
// Replaces `engram view` in a program that is built without the viewer (ENGRAM_VIEWER).
#include "cli/command.h"

namespace engram::cli {

void add_view_command(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("view", "See a memory in the browser (not built)");
  command->footer("This program was built without it: docs/viewer.md says how to get it.");
  command->allow_extras();
  command->callback([&exit_code] {
    exit_code = fail(failed_precondition(
        "this program was built without the viewer; to get it, install libboost-dev, nodejs and "
        "npm, and build Engram with -DENGRAM_VIEWER=ON"));
  });
}

}  // namespace engram::cli
