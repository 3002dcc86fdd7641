// SPDX-License-Identifier: Apache-2.0
#include "cli/help_texts.h"

#include <sstream>

#include "cli/usage.h"
#include "ltm/core/file.h"

namespace engram::cli {

namespace {

/// Obtains the text by running the program's own parser, so that it cannot differ.
std::string help_of(CLI::App& app, const std::string& words) {
  std::ostringstream out;
  std::ostringstream err;
  try {
    app.parse(words + " --help", false);
  } catch (const CLI::ParseError& error) {
    app.exit(error, out, err);
  }
  return out.str();
}

}  // namespace

Status write_help_texts(CLI::App& app, const std::filesystem::path& directory) {
  ENGRAM_RETURN_IF_ERROR(make_directories(directory));
  const auto write = [&](const CLI::App& command, const std::string& words, const std::string& name,
                         const auto& again) -> Status {
    ENGRAM_RETURN_IF_ERROR(
        replace_file(directory / (name + ".txt"), as_bytes(help_of(app, words))));
    for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; }))
      ENGRAM_RETURN_IF_ERROR(
          again(*below, words + " " + below->get_name(), name + "." + below->get_name(), again));
    return {};
  };
  ENGRAM_RETURN_IF_ERROR(write(app, "", "help", write));
  return replace_file(directory / "usage.txt", as_bytes(usage_text(app)));
}

}  // namespace engram::cli
