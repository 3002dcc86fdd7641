// SPDX-License-Identifier: Apache-2.0
#include "cli/usage.h"

#include <algorithm>
#include <sstream>
#include <string_view>

namespace engram::cli {

namespace {

/// Marks an option whose values the program validates: its description begins with this.
constexpr const char* kChecked = "checked";

// Each line is a kind and its fields, each after a tab.
constexpr const char* kCommand = "command";
constexpr const char* kOption = "option";
constexpr const char* kNeeds = "needs";
constexpr const char* kExcludes = "excludes";

std::string full_name(const CLI::Option& option) {
  return option.get_name(true, true);
}

bool is_flag(const CLI::Option& option) {
  return option.get_expected_max() == 0;
}

bool is_checked(const CLI::Option& option) {
  return option.get_trigger_on_parse() || (!is_flag(option) && option.get_type_name() != "TEXT");
}

/// All options of a program or command, in the order in which they were added.
std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  std::vector<const CLI::Option*> own;
  for (const CLI::Option* option : app.get_options())
    if (option != app.get_help_ptr() && option != app.get_version_ptr()) own.push_back(option);
  return own;
}

void write_options(const CLI::App& app, std::ostream& out) {
  const auto options = options_of(app);
  for (const CLI::Option* option : options)
    out << kOption << '\t' << full_name(*option) << '\t' << option->get_type_name() << '\t'
        << option->get_type_size_min() << '\t' << option->get_type_size_max() << '\t'
        << option->get_expected_min() << '\t' << option->get_expected_max() << '\t'
        << static_cast<int>(option->get_multi_option_policy()) << '\t' << option->get_required()
        << '\t' << option->get_allow_extra_args() << '\t' << int{option->get_delimiter()} << '\t'
        << is_checked(*option) << '\n';
  for (const CLI::Option* option : options) {
    const std::string first = '\t' + option->get_name() + '\t';
    for (const CLI::Option* other : option->get_needs())
      out << kNeeds << first << other->get_name() << '\n';
    for (const CLI::Option* other : option->get_excludes())
      out << kExcludes << first << other->get_name() << '\n';
  }
}

void write_command(const CLI::App& app, size_t depth, std::ostream& out) {
  out << kCommand << '\t' << depth << '\t' << app.get_name() << '\t'
      << app.get_require_subcommand_min() << '\t' << app.get_require_subcommand_max() << '\t'
      << app.get_allow_extras() << '\n';
  write_options(app, out);
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; }))
    write_command(*below, depth + 1, out);
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, '\t');) fields.push_back(field);
  return fields;
}

void add_option(CLI::App& app, const std::vector<std::string>& fields) {
  const auto number = [&](size_t i) { return std::stoi(fields.at(i)); };
  const bool is_flag = number(6) == 0;
  CLI::Option* option = is_flag ? app.add_flag(fields[1]) : app.add_option(fields[1]);
  if (!is_flag) {
    option->type_name(fields[2])->type_size(number(3), number(4));
    option->expected(number(5), number(6));
  }
  option->multi_option_policy(static_cast<CLI::MultiOptionPolicy>(number(7)));
  option->required(number(8) != 0)->allow_extra_args(number(9) != 0);
  option->delimiter(static_cast<char>(number(10)));
  if (number(11) != 0) option->description(kChecked);
}

/// Reads one line. `path` holds the commands from the program down to the current one.
void read_line(std::vector<CLI::App*>& path, const std::vector<std::string>& fields) {
  const std::string& kind = fields.at(0);
  if (kind == kCommand) {
    const auto depth = static_cast<size_t>(std::stoul(fields.at(1)));
    path.resize(std::max<size_t>(std::min(path.size(), depth), 1));
    if (depth == 0)
      path.back()->name(fields.at(2));
    else
      path.push_back(path.back()->add_subcommand(fields.at(2)));
    path.back()->require_subcommand(std::stoul(fields.at(3)), std::stoul(fields.at(4)));
    path.back()->allow_extras(fields.at(5) != "0");
  } else if (kind == kOption) {
    add_option(*path.back(), fields);
  } else if (kind == kNeeds) {
    path.back()->get_option(fields.at(1))->needs(path.back()->get_option(fields.at(2)));
  } else if (kind == kExcludes) {
    path.back()->get_option(fields.at(1))->excludes(path.back()->get_option(fields.at(2)));
  }
}

/// Whether a value was given that the program would validate, such as that of --flag=value.
bool has_checked(const CLI::App& app) {
  const auto is_looked_at = [](const CLI::Option* option) {
    const bool has_value =
        is_flag(*option) &&
        std::ranges::any_of(option->results(), [](auto& one) { return one != "true"; });
    return option->count() > 0 && (has_value || option->get_description() == kChecked);
  };
  return std::ranges::any_of(app.get_options(), is_looked_at) ||
         std::ranges::any_of(app.get_subcommands(),
                             [](const CLI::App* one) { return has_checked(*one); });
}

}  // namespace

std::string usage_text(const CLI::App& app) {
  std::ostringstream out;
  write_command(app, 0, out);
  return out.str();
}

bool read_usage(const std::string& text, CLI::App& app) {
  std::vector<CLI::App*> path{&app};
  std::istringstream lines(text);
  try {
    // Added as the program adds it, so that --version is no error.
    app.set_version_flag("--version", "");
    for (std::string line; std::getline(lines, line);) read_line(path, fields_of(line));
  } catch (const std::exception&) {
    return false;
  }
  return !text.empty();
}

std::string wrong_usage_text(CLI::App& app, std::vector<std::string> arguments) {
  std::ranges::reverse(arguments);  // CLI11 takes the arguments in reverse order.
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0 || has_checked(app)) return "";
    std::ostringstream out;
    std::ostringstream err;
    app.exit(error, out, err);
    return err.str();
  }
  return "";
}

}  // namespace engram::cli
