// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <map>

#include "cli/commit_lines.h"
#include "cli/idf_files.h"
#include "cli/remote_client.h"
#include "cli/server_commands.h"
#include "ltm/core/file.h"
#include "ltm/idf/json.h"
#include "ltm/idf/type_xml.h"
#include "memory/prior/picture_file.h"
#include "memory/prior/written_as.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter =
    R"(Tells a server a snapshot, and prints its ID when the server has it. Values are IDF's JSON form
(ltm/idf/json.h): plain JSON, with tags as in {"$float32": 0.5} where needed. With --lines many:
one object per line, {"entity": ID, "time": TIME, "data": VALUE}, or what 'engram watch --data
--json' and 'engram export --to jsonl' write.

With --type the last object of an XML file is declared to be what the values of the entity's
provider segment are; lists of numbers become its arrays, names the values of its enums.

Examples:
  engram commit Objects/Things/kitchen/cup --data '{"height": 0.11}'
  engram commit Vision/RGB/head/cam --image image=cam.png --time '2022-02-18 13:06:56.49'
  engram commit Objects/Things/kitchen/cup --file cup.json --type things.xml
  engram commit --lines snapshots.jsonl --durability journal
  engram watch Vision --data --json | engram commit --server 10.0.0.2:50051 --lines -)";

constexpr int64_t kMostPixels = 256'000'000;

struct CommitArguments {
  RemoteArguments remote;
  std::string entity;
  std::string data;
  std::string file;
  std::vector<std::string> images;
  std::string time;
  std::string type;
  std::string type_name;
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

/// Adds a picture to a value: "NAME=FILE" as a member, "FILE" as all of it.
Status add_image(const std::string& text, std::optional<idf::Data>& value) {
  const size_t equals = text.find('=');
  const std::string file = equals == std::string::npos ? text : text.substr(equals + 1);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, read_file(file));
  auto image = memory::read_picture(bytes.bytes(), kMostPixels);
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

/// The type of a file that was named, else its last object.
Result<idf::Type> read_type(const CommitArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::TypeFile file, idf::read_type_file(arguments.type));
  if (!arguments.type_name.empty()) return find_type(file, arguments.type_name);
  const auto last = std::find_if(file.types.rbegin(), file.types.rend(), [](const idf::Type& type) {
    return type.kind() == idf::TypeKind::kObject;
  });
  if (last != file.types.rend()) return *last;
  return not_found("'{}' defines no object, needs one", arguments.type);
}

void tell(const CommitArguments& arguments, const ltm::MemoryId& id) {
  if (arguments.is_json)
    print_json({{"committed", 1}, {"id", id.to_string()}});
  else
    print(id.to_string());
}

ExitCode commit_one(const CommitArguments& arguments) {
  ltm::EntityUpdate update{*ltm::MemoryId::parse(arguments.entity), system_now(), {}};
  if (!arguments.time.empty()) update.time = *parse_time(arguments.time);
  auto value = value_of(arguments);
  if (!value.ok())
    return value.status().code() == StatusCode::kInvalidArgument ? wrong_usage(value.status())
                                                                 : fail(value.status());
  const auto client = open_client(arguments.remote, update.entity.names().front());
  if (!client.ok()) return fail(client.status());
  if (!arguments.type.empty()) {
    const auto type = read_type(arguments);
    if (!type.ok()) return fail(type.status());
    if (const Status declared = (*client)->declare(update.entity.parent(), *type); !declared.ok())
      return fail(declared);
    value = memory::written_as(*type, *std::move(value));
  }
  update.instances.push_back(
      {*std::move(value),
       {.created = update.time, .sent = system_now(), .provider = "engram commit"}});
  const ltm::MemoryId id = update.id();
  const Status done = (*client)->commit({{std::move(update)}}, durability_of(arguments));
  if (!done.ok()) return fail(done);
  tell(arguments, id);
  return ExitCode::kDone;
}

/// Takes each part of a commit to the server that has its memory.
class ByMemory {
 public:
  explicit ByMemory(const CommitArguments& arguments) : arguments_(arguments) {}

  Status commit(const ltm::Commit& all) {
    std::map<std::string, ltm::Commit> parts;
    for (const ltm::EntityUpdate& update : all.updates) {
      const bool is_one = arguments_.remote.names.empty();
      parts[is_one ? "" : update.entity.names().front()].updates.push_back(update);
    }
    for (const auto& [memory, part] : parts) {
      auto& client = clients_[memory];
      if (!client) {
        ENGRAM_ASSIGN_OR_RETURN(client, open_client(arguments_.remote, memory));
      }
      ENGRAM_RETURN_IF_ERROR(client->commit(part, durability_of(arguments_)));
    }
    return {};
  }

 private:
  const CommitArguments& arguments_;
  std::map<std::string, std::unique_ptr<server::MemoryClient>> clients_;
};

ExitCode commit_many(const CommitArguments& arguments) {
  const bool is_stdin = arguments.lines == "-";
  std::ifstream file(is_stdin ? "/dev/stdin" : arguments.lines);
  if (!file) return fail(not_found("'{}' cannot be read", arguments.lines));
  ByMemory servers(arguments);
  const auto taken =
      commit_lines(file, [&servers](const ltm::Commit& commit) { return servers.commit(commit); });
  if (!taken.ok()) return fail(taken.status());
  if (arguments.is_json)
    print_json({{"committed", *taken}});
  else
    print(fmt::format("{} snapshots committed", reports::count_text(*taken)));
  return ExitCode::kDone;
}

ExitCode run(const CommitArguments& arguments) {
  if (const Status named = check_source("", arguments.remote); !named.ok())
    return wrong_usage(named);
  if (arguments.entity.empty() == arguments.lines.empty())
    return wrong_usage(invalid_argument("needs either an entity or --lines"));
  return arguments.lines.empty() ? commit_one(arguments) : commit_many(arguments);
}

}  // namespace

void add_commit_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<CommitArguments>();
  CLI::App* command = app.add_subcommand("commit", "Tell a server the state of an entity");
  command->footer(kFooter);
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
  auto* type = add("--type", arguments->type, "XML file that says what the values are");
  add("--type-name", arguments->type_name, "Which type of the file; else its last object")
      ->needs(type);
  command
      ->add_option("--durability", arguments->durability,
                   "When it counts as done: as the server says, when others can read it, or "
                   "when it survives kill -9")
      ->check(CLI::IsMember({"server", "memory", "journal"}))
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "As JSON");
  add_remote_options(*command, arguments->remote);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
