// SPDX-License-Identifier: Apache-2.0
#include "cli/remote.h"

#include <algorithm>

#include "cli/remote_client.h"
#include "ltm/core/printable.h"
#include "reports/plain/text.h"

namespace engram::cli {

using server::Registration;

namespace {

ExitCode show_names(const RemoteArguments& arguments, ServerFigures form) {
  if (form == ServerFigures::kMetrics)
    return wrong_usage(invalid_argument("--metrics is of a server: needs --server"));
  auto servers = known_servers(arguments);
  if (!servers.ok()) return fail(servers.status());
  // Sorted, so that what two calls print can be compared.
  std::ranges::sort(*servers, {}, &Registration::server);
  if (form == ServerFigures::kJson) {
    Json json = Json::array();
    for (const Registration& one : *servers)
      json.push_back(
          {{"server", one.server}, {"memories", one.memories}, {"endpoints", one.endpoints}});
    print_json({{"servers", std::move(json)}});
    return ExitCode::kDone;
  }
  print(fmt::format("Name system at {}: {} servers", arguments.names, servers->size()));
  for (const Registration& one : *servers)
    print(fmt::format("  {}: {} at {}", one.server, memories_text(one.memories),
                      fmt::join(one.endpoints, ", ")));
  return ExitCode::kDone;
}

/// Returns "waiting bytes" for "memory_waiting_bytes".
std::string label(std::string name, std::string_view start) {
  name.erase(0, start.size());
  std::ranges::replace(name, '_', ' ');
  return name;
}

std::string figure_text(const std::string& name, const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_unsigned()) return value.dump();
  const auto number = value.get<uint64_t>();
  return name.ends_with("bytes") ? reports::bytes_text(static_cast<double>(number))
                                 : reports::count_text(number);
}

/// Prints a table for each prefix of the names, and one for all other figures. So a server of a
/// later version may have figures that this program does not know, and none of them is left out.
void print_figures(const Json& figures) {
  constexpr std::string_view kMemory = "memory_";
  constexpr std::string_view kStore = "store_";
  const auto print_part = [&figures](const std::string& title, std::string_view start) {
    reports::TextTable table({title, ""});
    bool has_any = false;
    for (const auto& [name, value] : figures.items()) {
      const bool is_rest = !name.starts_with(kMemory) && !name.starts_with(kStore);
      if (start.empty() ? !is_rest : !name.starts_with(start)) continue;
      table.add({label(name, start), figure_text(name, value)});
      has_any = true;
    }
    if (has_any) print("\n" + table.to_string("  "));
  };
  print_part("working memory", kMemory);
  print_part("store", kStore);
  print_part("asked", "");
}

}  // namespace

std::string memories_text(const std::vector<std::string>& memories) {
  return memories.empty() ? "all memories" : fmt::format("{}", fmt::join(memories, ", "));
}

ExitCode show_server(const RemoteArguments& arguments, ServerFigures form) {
  if (!arguments.names.empty()) return show_names(arguments, form);
  const auto client = open_client(arguments);
  if (!client.ok()) return fail(client.status());
  if (form == ServerFigures::kMetrics) {
    const auto metrics = (*client)->metrics();
    if (!metrics.ok()) return fail(metrics.status());
    fmt::print("{}", printable_lines(*metrics));
    return ExitCode::kDone;
  }
  const auto info = (*client)->info();
  if (!info.ok()) return fail(info.status());
  // The text comes from another process: what is wrong with it is reported and throws nothing here.
  const Json figures = Json::parse(info->figures_json, nullptr, false);
  if (figures.is_discarded())
    return fail(data_loss("server '{}': its figures are no JSON", info->server));
  if (form == ServerFigures::kJson) {
    print_json({{"server", info->server},
                {"version", info->version},
                {"memories", info->memories},
                {"figures", figures}});
    return ExitCode::kDone;
  }
  print(fmt::format("Server {}, engram {}: {}", info->server, info->version,
                    memories_text(info->memories)));
  print_figures(figures);
  return ExitCode::kDone;
}

}  // namespace engram::cli
