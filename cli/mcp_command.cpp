// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <string>

#include "cli/ask_model.h"
#include "cli/command.h"
#include "cli/remote.h"
#include "cli/speech_options.h"
#include "speech/assistants/asking_tools.h"
#include "speech/assistants/mcp_session.h"
#include "speech/assistants/memory_tools.h"

namespace engram::cli {

namespace {

constexpr const char* kMcpFooter =
    R"(Speaks the Model Context Protocol on stdin and stdout, so that an assistant which starts this
command can ask the memory: what the robot did and why (ask, timeline, why), what it knows (entities,
query, picture), what was near a place (near), and when it was like this before (similar). It only
reads, and ends when stdin does. How assistants are told of it: docs/assistants.md.

Examples:
  engram mcp robot.engram
  engram mcp --server unix:/run/engram.sock)";

constexpr const char* kInstructions =
    "This is the episodic memory of a robot: what it perceived, was told and did. Ask 'ask' or "
    "'timeline' first, and 'entities' and 'query' for what those do not tell. Links in values lead "
    "to other snapshots, and 'why' follows them. Say "
    "only "
    "what an answer shows, name the snapshots that show it by their IDs, and say that the memory "
    "does not know where it does not. Times are UTC.";

struct McpArguments {
  std::string store;
  RemoteArguments remote;
};

/// Reads a line, of which no more is kept than a session takes. False at the end.
bool read_line(std::istream& in, std::string& line) {
  line.clear();
  bool is_any = false;
  for (int c = in.get(); c != std::istream::traits_type::eof(); c = in.get()) {
    is_any = true;
    if (c == '\n') return true;
    // One byte more, so that the session sees that it is too long.
    if (line.size() <= speech::McpSession::kMaxMessage) line.push_back(static_cast<char>(c));
  }
  return is_any;
}

ExitCode run(const McpArguments& arguments) {
  if (const Status named = check_source(arguments.store, arguments.remote); !named.ok())
    return wrong_usage(named);
  const auto memory = open_memory(arguments.store, {.is_read_only = true}, arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  auto reader = reader_of({}, arguments.store);
  if (!reader.ok()) return fail(reader.status());
  auto asker = speech::Asker::create(**memory, {.zone = day_zone(), .reader = *std::move(reader)});
  if (!asker.ok()) return fail(asker.status());
  std::vector<speech::MemoryTool> tools = speech::asking_tools(*std::move(asker));
  for (speech::MemoryTool& tool : speech::memory_tools(**memory)) tools.push_back(std::move(tool));
  speech::McpSession session(std::move(tools),
                             {.version = ENGRAM_VERSION, .instructions = kInstructions});
  std::string line;
  while (read_line(std::cin, line)) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    const std::string answer = session.answer(line);
    if (answer.empty()) continue;
    std::cout << answer << '\n' << std::flush;
    // Whoever asked is gone.
    if (!std::cout) break;
  }
  return ExitCode::kDone;
}

}  // namespace

void add_mcp_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<McpArguments>();
  CLI::App* command = app.add_subcommand("mcp", "Let an assistant use a memory");
  command->footer(kMcpFooter);
  command->add_option("store", arguments->store, "Store; none where a server is asked");
  add_remote_options(*command, arguments->remote);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
