// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <map>

#include "cli/commit_lines.h"
#include "cli/idf_files.h"
#include "cli/remote.h"
#include "cli/server_commands.h"
#include "ltm/core/file.h"
#include "ltm/idf/json.h"
#include "ltm/idf/type_xml.h"
#include "memory/prior/picture_file.h"
#include "memory/prior/written_as.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr const char* kCommitFooter =
    R"(Tells a server a snapshot, or with --db a store that nobody else writes to, and prints its ID when
it is there. Values are IDF's JSON form (ltm/idf/json.h): plain JSON, with tags as in
{"$float32": 0.5} where needed. With --lines many: one object per line, {"entity": ID, "time": TIME,
"data": VALUE}, or what 'engram watch --data --json' and 'engram export --to jsonl' write.

With --types the last object of an XML file is declared to be what the values of the entity's
provider segment are; lists of numbers become its arrays, names the values of its enums.

Examples:
  engram commit Objects/Things/kitchen/cup --data '{"height": 0.11}'
  engram commit Vision/RGB/head/cam --image image=cam.png --time '2022-02-18 13:06:56.49'
  engram commit Objects/Things/kitchen/cup --file cup.json --types things.xml
  engram commit --lines snapshots.jsonl --durability journal
  engram commit --db robot.engram --lines snapshots.jsonl
  engram watch Vision --data --json | engram commit --server 10.0.0.2:50051 --lines -)";

constexpr int64_t kMaxPixels = 256'000'000;

struct CommitArguments {
  std::string store;
  RemoteArguments remote;
  std::string entity;
  std::string data;
  std::string file;
  std::vector<std::string> images;
  std::string time;
  std::string types;
  std::string type;
  std::string lines;
  std::string durability = "server";
  bool is_json = false;
};

CommitDurability durability_of(const CommitArguments& arguments) {
  static const std::map<std::string, CommitDurability> kLevels{
      {"server", CommitDurability::kDefault},
      {"memory", CommitDurability::kMemory},
      {"journal", CommitDurability::kJournal}};
  return kLevels.at(arguments.durability);
}

/// Adds a picture to a value: "NAME=FILE" adds a member, "FILE" is the whole value.
Status add_image(const std::string& text, std::optional<idf::Data>& value) {
  const size_t equals = text.find('=');
  const std::string file = equals == std::string::npos ? text : text.substr(equals + 1);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(file));
  auto image = memory::read_picture(bytes.bytes(), kMaxPixels);
  if (!image.ok()) return image.status().with_context(file);
  if (equals == std::string::npos) {
    if (value)
      return invalid_argument(
          "--image {}: needs a name beside other data, as in "
          "image={}",
          text, text);
    value = *std::move(image);
    return {};
  }
  if (!value) value = idf::Dict{};
  auto* dict = value->get_if<idf::Dict>();
  if (dict == nullptr)
    return invalid_argument("--image {}: found {}, needs an object to be a member of", text,
                            value->kind_name());
  dict->set(text.substr(0, equals), *std::move(image));
  return {};
}

Result<idf::Data> value_of(const CommitArguments& arguments) {
  std::optional<idf::Data> value;
  if (!arguments.data.empty()) {
    auto parsed = idf::from_json_text(arguments.data);
    if (!parsed.ok()) return parsed.status().with_context("--data");
    value = *std::move(parsed);
  }
  if (!arguments.file.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(value, read_value(arguments.file));
  }
  for (const std::string& image : arguments.images) ENGRAM_RETURN_IF_ERROR(add_image(image, value));
  if (!value) return invalid_argument("has no data, needs --data, --file or --image");
  return *std::move(value);
}

/// Returns the named type of a file, or its last object type.
Result<idf::Type> read_type(const CommitArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::TypeFile file, idf::read_type_file(arguments.types));
  if (!arguments.type.empty()) return find_type(file, arguments.type);
  const auto last = std::find_if(file.types.rbegin(), file.types.rend(), [](const idf::Type& type) {
    return type.kind() == idf::TypeKind::kObject;
  });
  if (last != file.types.rend()) return *last;
  return not_found("'{}' defines no object, needs one", arguments.types);
}

void tell(const CommitArguments& arguments, const ltm::MemoryId& id) {
  if (arguments.is_json)
    print_json({{"committed", 1}, {"id", id.to_string()}});
  else
    print(id.printable());
}

ExitCode commit_one(const CommitArguments& arguments) {
  ltm::EntityUpdate update{*ltm::MemoryId::parse(arguments.entity), system_now(), {}};
  if (!arguments.time.empty()) update.time = *parse_time(arguments.time);
  auto value = value_of(arguments);
  if (!value.ok())
    return value.status().code() == StatusCode::kInvalidArgument ? wrong_usage(value.status())
                                                                 : fail(value.status());
  const auto memory = open_memory(arguments.store, {}, arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  if (!arguments.types.empty()) {
    const auto type = read_type(arguments);
    if (!type.ok()) return fail(type.status());
    if (const Status declared = (*memory)->declare(update.entity.parent(), *type); !declared.ok())
      return fail(declared);
    value = memory::written_as(*type, *std::move(value));
  }
  update.instances.push_back(
      {*std::move(value),
       {.created = update.time, .sent = system_now(), .provider = "engram commit"}});
  const ltm::MemoryId id = update.id();
  Status done = (*memory)->commit({{std::move(update)}}, durability_of(arguments));
  // close() writes what a store has not sealed yet, so its failure is a failure of the commit.
  if (done.ok()) done = (*memory)->close();
  if (!done.ok()) return fail(done);
  tell(arguments, id);
  return ExitCode::kDone;
}

ExitCode commit_many(const CommitArguments& arguments) {
  const bool is_stdin = arguments.lines == "-";
  std::ifstream file(is_stdin ? "/dev/stdin" : arguments.lines);
  if (!file) return fail(not_found("'{}' cannot be read", arguments.lines));
  const auto memory = open_memory(arguments.store, {}, arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  const auto taken = commit_lines(file, [&](const ltm::Commit& commit) {
    return (*memory)->commit(commit, durability_of(arguments));
  });
  const Status closed = (*memory)->close();
  if (!taken.ok()) return fail(taken.status());
  if (!closed.ok()) return fail(closed);
  if (arguments.is_json)
    print_json({{"committed", *taken}});
  else
    print(fmt::format("{} snapshots committed", reports::count_text(*taken)));
  return ExitCode::kDone;
}

ExitCode run(const CommitArguments& arguments) {
  if (const Status named = check_source(arguments.store, arguments.remote); !named.ok())
    return wrong_usage(named);
  if (arguments.entity.empty() == arguments.lines.empty())
    return wrong_usage(invalid_argument("needs either an entity or --lines"));
  return arguments.lines.empty() ? commit_one(arguments) : commit_many(arguments);
}

}  // namespace

void add_commit_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<CommitArguments>();
  CLI::App* command =
      app.add_subcommand("commit", "Tell a server or a store the state of an entity");
  command->footer(kCommitFooter);
  auto* lines = command->add_option("--lines", arguments->lines,
                                    "Many snapshots, a line of JSON each; '-': stdin");
  const auto add = [command, lines](const char* name, auto& value, const char* help) {
    return command->add_option(name, value, help)->excludes(lines);
  };
  add("entity", arguments->entity, "Memory/Core/Provider/Entity")->check(entity_text());
  auto* data = add("--data", arguments->data, "Value as JSON");
  add("--file", arguments->file, "File with the value: .json or .idf")->excludes(data);
  add("--image", arguments->images, "PNG or JPEG file that is the value, or NAME=FILE: a member")
      ->allow_extra_args(false);
  add("--time", arguments->time, "When it was like that; else now")->check(time_text());
  auto* types = add("--types", arguments->types, "XML file that says what the values are");
  add("--type", arguments->type, "Which type of the file; else its last object")->needs(types);
  command->add_option("--db", arguments->store,
                      "Store to tell in place of a server; made where there is none");
  command
      ->add_option("--durability", arguments->durability,
                   "When it counts as done: as the server says (a store: journal), when others can "
                   "read it, or when it survives kill -9")
      ->check(CLI::IsMember({"server", "memory", "journal"}))
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "As JSON");
  add_remote_options(*command, arguments->remote);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
