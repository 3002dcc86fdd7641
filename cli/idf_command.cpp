// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "cli/command.h"
#include "cli/idf_files.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/idf/generate_cpp.h"
#include "ltm/idf/generate_python.h"
#include "ltm/idf/json.h"
#include "ltm/idf/type_check.h"

namespace engram::cli {

namespace {

namespace fs = std::filesystem;

struct GenerateArguments {
  std::vector<std::string> files;
  std::string cpp;
  std::string python;
  std::vector<std::string> include_paths;
  bool is_check = false;
};

constexpr const char* kGenerateFooter =
    R"(Writes types.h and types.cpp, or types.py, for types.xml; only files that change are written.
Files that types.xml includes are generated on their own.

Examples:
  engram idf generate kitchen.xml --cpp generated --python python/robot_types
  engram idf generate *.xml -I types --cpp generated --check)";

struct ShowArguments {
  std::string file;
  std::string type;
  std::vector<std::string> include_paths;
  bool is_json = false;
};

constexpr const char* kShowFooter = R"(A .xml shows its types, a .json or .idf file its value.

Examples:
  engram idf show kitchen.xml
  engram idf show kitchen.xml kitchen::Cup --json
  engram idf show cup.idf)";

struct TypeCheckArguments {
  std::string value;
  std::string types;
  std::string type;
  std::vector<std::string> include_paths;
};

constexpr const char* kTypeCheckFooter = R"(Exit code 1 where the value is not of the type.

Example:
  engram idf check cup.json --types kitchen.xml --type kitchen::Cup)";

struct ConvertArguments {
  std::string from;
  std::string to;
};

constexpr const char* kConvertFooter = R"(Examples:
  engram idf convert cup.idf cup.json
  engram idf convert cup.json cup.idf)";

std::vector<fs::path> paths_of(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

/// Writes the files that differ, or with `is_check` only prints their names, and counts them.
Status place_files(const std::vector<idf::GeneratedFile>& files, const std::string& directory,
                   bool is_check, size_t& changed) {
  if (!is_check) ENGRAM_RETURN_IF_ERROR(make_directories(directory));
  for (const idf::GeneratedFile& file : files) {
    const fs::path path = fs::path(directory) / file.name;
    std::error_code error;
    if (fs::exists(path, error)) {
      ENGRAM_ASSIGN_OR_RETURN(const Buffer old, read_file(path));
      // An unchanged file keeps its time stamp, so that builds do not compile its users again.
      if (as_text(old.bytes()) == file.text) continue;
    }
    ++changed;
    if (!is_check) ENGRAM_RETURN_IF_ERROR(replace_file(path, as_bytes(file.text)));
    print((is_check ? "differs: " : "") + path.string());
  }
  return {};
}

Result<size_t> generate(const GenerateArguments& arguments) {
  size_t changed = 0;
  for (const std::string& name : arguments.files) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::TypeFile file,
                            idf::read_type_file(name, paths_of(arguments.include_paths)));
    for (const std::string& note : file.notes) log::warning("{}", note);
    if (!arguments.cpp.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto files, idf::generate_cpp(file));
      ENGRAM_RETURN_IF_ERROR(place_files(files, arguments.cpp, arguments.is_check, changed));
    }
    if (!arguments.python.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto files, idf::generate_python(file));
      ENGRAM_RETURN_IF_ERROR(place_files(files, arguments.python, arguments.is_check, changed));
    }
  }
  return changed;
}

ExitCode run_generate(const GenerateArguments& arguments) {
  if (arguments.cpp.empty() && arguments.python.empty())
    return wrong_usage(invalid_argument("generate: needs --cpp DIR, --python DIR or both"));
  const auto changed = generate(arguments);
  if (!changed.ok()) return fail(changed.status());
  return arguments.is_check && *changed > 0 ? ExitCode::kFailed : ExitCode::kDone;
}

void show_type(const idf::Type& type) {
  if (!type.doc().empty()) print("# " + type.doc());
  print(idf::to_string(type, idf::TypeText::kLines));
}

Status show_types(const ShowArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::TypeFile file,
                          idf::read_type_file(arguments.file, paths_of(arguments.include_paths)));
  std::vector<idf::Type> types = file.types;
  if (!arguments.type.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::Type type, find_type(file, arguments.type));
    types = {type};
  }
  for (const idf::Type& type : types) {
    if (!arguments.is_json) {
      show_type(type);
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(const std::string text, idf::to_json_text(idf::to_data(type), 2));
    print(text);
  }
  return {};
}

Status show(const ShowArguments& arguments) {
  if (fs::path(arguments.file).extension() == ".xml") return show_types(arguments);
  if (!arguments.type.empty())
    return invalid_argument("'{}': a TYPE can be shown of a .xml file alone", arguments.file);
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, read_value(arguments.file));
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, idf::to_json_text(value, 2));
  print(text);
  return {};
}

Result<std::vector<idf::Mismatch>> check(const TypeCheckArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::TypeFile file,
                          idf::read_type_file(arguments.types, paths_of(arguments.include_paths)));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Type type, find_type(file, arguments.type));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, read_value(arguments.value));
  return idf::check(value, type);
}

ExitCode run_check(const TypeCheckArguments& arguments) {
  const auto mismatches = check(arguments);
  if (!mismatches.ok()) return fail(mismatches.status());
  for (const idf::Mismatch& mismatch : *mismatches) print(mismatch.to_string());
  return mismatches->empty() ? ExitCode::kDone : ExitCode::kFailed;
}

Status convert(const ConvertArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, read_value(arguments.from));
  return write_value(value, arguments.to);
}

void add_include_option(CLI::App& command, std::vector<std::string>& paths) {
  command.add_option("-I,--include", paths, "Where included XML files are looked for")
      ->type_name("DIR")
      ->allow_extra_args(false);
}

void add_generate(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<GenerateArguments>();
  CLI::App* command = app.add_subcommand("generate", "Write C++ or Python for types in XML");
  command->footer(kGenerateFooter);
  command->add_option("files", arguments->files, "Types (.xml)")->required();
  command->add_option("--cpp", arguments->cpp, "Folder for C++")->type_name("DIR");
  command->add_option("--python", arguments->python, "Folder for Python")->type_name("DIR");
  add_include_option(*command, arguments->include_paths);
  command->add_flag("--check", arguments->is_check,
                    "Write nothing; exit code 1 where files differ from what would be written");
  command->callback([arguments, &exit_code] { exit_code = run_generate(*arguments); });
}

void add_show(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ShowArguments>();
  CLI::App* command = app.add_subcommand("show", "Print types or a value");
  command->footer(kShowFooter);
  command->add_option("file", arguments->file, "Types (.xml) or a value (.json, .idf)")->required();
  command->add_option("type", arguments->type, "Name of one type");
  add_include_option(*command, arguments->include_paths);
  command->add_flag("--json", arguments->is_json, "Types as JSON on stdout");
  command->callback([arguments, &exit_code] { exit_code = done_or_failed(show(*arguments)); });
}

void add_check(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<TypeCheckArguments>();
  CLI::App* command = app.add_subcommand("check", "Tell where a value is not of a type");
  command->footer(kTypeCheckFooter);
  command->add_option("value", arguments->value, "Value (.json, .idf)")->required();
  command->add_option("--types", arguments->types, "Types (.xml)")->required()->type_name("FILE");
  command->add_option("--type", arguments->type, "Name of the type")->required()->type_name("NAME");
  add_include_option(*command, arguments->include_paths);
  command->callback([arguments, &exit_code] { exit_code = run_check(*arguments); });
}

void add_convert(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = app.add_subcommand("convert", "Turn a value into another form");
  command->footer(kConvertFooter);
  command->add_option("from", arguments->from, "Value (.json, .idf)")->required();
  command->add_option("to", arguments->to, "File to write (.json, .idf)")->required();
  command->callback([arguments, &exit_code] { exit_code = done_or_failed(convert(*arguments)); });
}

}  // namespace

void add_idf_commands(CLI::App& app, ExitCode& exit_code) {
  app.require_subcommand(1);
  add_generate(app, exit_code);
  add_show(app, exit_code);
  add_check(app, exit_code);
  add_convert(app, exit_code);
}

void add_idf_command(CLI::App& app, ExitCode& exit_code) {
  CLI::App* command = app.add_subcommand("idf", "Types and values: generate code, show, check");
  command->footer(R"(Examples:
  engram idf generate kitchen.xml --cpp generated --python python/robot_types
  engram idf show kitchen.xml kitchen::Cup
  engram idf check cup.json --types kitchen.xml --type kitchen::Cup
  engram idf convert cup.idf cup.json)");
  add_idf_commands(*command, exit_code);
}

}  // namespace engram::cli
