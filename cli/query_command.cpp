// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/remote.h"
#include "reports/plain/result_text.h"

namespace engram::cli {

namespace {

constexpr const char* kQueryFooter =
    R"(A query is NAMES @ SELECTOR. NAMES are Memory/Core/Provider/Entity, each a name or a regular
expression; missing ones match all. Without a selector: latest.
  latest  latest:3       the last one, the last three
  all                    every one
  TIME                   at exactly that time; a prediction where it lies after the last one
  +200ms                 a prediction so long after the last one, by the engine that was best on
                         the entity's own past (engram predict --list), with the error to expect
                         and the bound that it keeps with a probability of 90 %
  nearest:TIME~50ms      the closest within a tolerance (without ~: any)
  before:TIME  at-or-before:TIME  after:TIME  until:TIME
  TIME..TIME             from and to, both included
  last:10s               the last ten seconds
  -3..-1                 by index, negative from the end
Several selectors are united by ',', whole queries by ';'; '#0' behind a selector asks for one
instance only, '?ids' in front for IDs without data.
TIME is '2022-02-18 13:06:56.492182', RFC 3339, or integer nanoseconds since 1970.

Examples:
  engram query robot.engram 'Vision/RGB/head/cam @ latest:3' --save answers
  engram query robot.engram '.*/.*/.*/joints @ last:2s' --json
  engram query robot.engram 'Vision/RGB/head/cam @ +200ms' --save future
  engram query robot.engram '.*/.*/.*/joints @ latest, +400ms, +1s'
  engram query --server 127.0.0.1:50051 'Vision/RGB/head/cam @ latest')";

struct QueryArguments {
  std::string store;
  std::string query;
  RemoteArguments remote;
  std::string save;
  std::string prefer = "recorded";
  bool is_json = false;
  bool is_unnoted = false;
};

ExitCode run(QueryArguments arguments) {
  // A single argument is a query to a server.
  if (arguments.query.empty()) std::swap(arguments.store, arguments.query);
  if (arguments.query.empty()) return wrong_usage(invalid_argument("query is required"));
  if (const Status named = check_source(arguments.store, arguments.remote); !named.ok())
    return wrong_usage(named);
  const auto query = ltm::Query::parse(arguments.query);
  if (!query.ok()) return wrong_usage(query.status());
  if (query->is_ids_only() && !arguments.save.empty())
    return wrong_usage(
        invalid_argument("query '{}' asks for IDs alone: --save needs data", arguments.query));
  if (arguments.store.empty() && arguments.prefer != "recorded")
    return wrong_usage(invalid_argument("--prefer is of a store: a server has it configured"));
  const OpenOptions options{.is_read_only = true,
                            .prefers_latents = arguments.prefer == "latent",
                            .notes_reads = !arguments.is_unnoted};
  const auto memory = open_memory(arguments.store, options, arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  reports::ResultWriter writer(arguments.save, arguments.is_json);
  const Status status = (*memory)->query_parts(
      *query, [&writer](const ltm::QueryResult& part) { return writer.add(part); });
  if (!status.ok()) return fail(status);
  writer.finish(query->is_ids_only());
  return ExitCode::kDone;
}

}  // namespace

void add_query_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<QueryArguments>();
  CLI::App* command = app.add_subcommand("query", "Ask about any moment, past or future");
  command->footer(kQueryFooter);
  command->add_option("store", arguments->store, "Store; none where a server is asked");
  command->add_option("query", arguments->query, "NAMES @ SELECTOR");
  add_remote_options(*command, arguments->remote);
  command->add_option("--save", arguments->save,
                      "Write images (PNG) and data (JSON) below a folder");
  command->add_option("--prefer", arguments->prefer, "Which form answers where both are there")
      ->check(CLI::IsMember({"recorded", "latent"}))
      ->capture_default_str();
  command->add_flag("--unnoted", arguments->is_unnoted,
                    "Do not note in the store what is read (docs/forgetting.md)");
  command->add_flag("--json", arguments->is_json, "All data as JSON on stdout");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
