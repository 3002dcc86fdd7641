// SPDX-License-Identifier: Apache-2.0
#include "cli/remote_client.h"

#include <stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "ltm/core/file.h"
#include "server/access/default_endpoint.h"
#include "server/client/names_client.h"

namespace engram::cli {

using server::Endpoint;
using server::MemoryClient;
using server::Registration;

namespace {

std::string from_environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool is_there(const Endpoint& endpoint) {
  return endpoint.kind() != Endpoint::Kind::kUnix || std::filesystem::exists(endpoint.path());
}

Status check_endpoint(const std::string& text, std::string_view option) {
  if (text.empty()) return {};
  const Status status = Endpoint::parse(text).status();
  return status.ok() ? status : status.with_context(option);
}

/// The best of those that a server listens on that can be on this machine.
Result<std::string> reachable(const Registration& registration) {
  for (const std::string& endpoint : registration.endpoints)
    if (const auto place = Endpoint::parse(endpoint); place.ok() && is_there(*place))
      return endpoint;
  return unavailable("server '{}' cannot be reached from here: it listens at {}",
                     registration.server, fmt::join(registration.endpoints, ", "));
}

}  // namespace

bool has_servers() {
  return true;
}

void add_remote_options(CLI::App& command, RemoteArguments& arguments) {
  constexpr const char* kGroup = "Server";
  command
      .add_option("--server", arguments.server,
                  "Endpoint: HOST:PORT or unix:PATH; else that of $ENGRAM_SERVER, else where "
                  "'engram serve' listens when nobody says where")
      ->group(kGroup);
  command.add_option("--names", arguments.names, "Endpoint of a name system that knows the server")
      ->excludes("--server")
      ->group(kGroup);
  command
      .add_option("--token", arguments.token,
                  "File with the token to show; else that of $ENGRAM_TOKEN")
      ->group(kGroup);
  command.add_option("--ca", arguments.ca, "PEM file: who vouches for servers on other machines")
      ->group(kGroup);
  command.add_option("--timeout", arguments.timeout, "How long to try")
      ->check(duration_text())
      ->capture_default_str()
      ->group(kGroup);
}

Status check_source(const std::string& store, const RemoteArguments& arguments) {
  const bool names_server = !arguments.server.empty() || !arguments.names.empty();
  if (!store.empty() && names_server)
    return invalid_argument("found the store '{}' and a server, needs one of them", store);
  if (!store.empty()) return {};
  ENGRAM_RETURN_IF_ERROR(check_endpoint(arguments.server, "--server"));
  ENGRAM_RETURN_IF_ERROR(check_endpoint(arguments.names, "--names"));
  if (names_server) return {};
  const std::string set = from_environment("ENGRAM_SERVER");
  if (!set.empty()) return check_endpoint(set, "ENGRAM_SERVER");
  const auto usual = server::default_endpoint();
  if (usual.ok() && is_there(*usual)) return {};
  return invalid_argument("needs a store, or a server: --server, --names or $ENGRAM_SERVER ({})",
                          usual.ok() ? fmt::format("none listens at {}", usual->to_string())
                                     : usual.status().message());
}

Result<server::ClientOptions> client_options(const RemoteArguments& arguments) {
  // What goes wrong there comes back as a status; gRPC would tell it on stderr too, for each try.
  ::setenv("GRPC_VERBOSITY", "NONE", 0);
  server::ClientOptions options;
  options.token = from_environment("ENGRAM_TOKEN");
  if (!arguments.token.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const Buffer text, read_file(arguments.token));
    options.token = as_text(text.bytes());
    options.token.erase(options.token.find_last_not_of("\r\n") + 1);
  }
  options.ca = arguments.ca;
  ENGRAM_ASSIGN_OR_RETURN(options.timeout, parse_duration(arguments.timeout));
  return options;
}

Result<std::string> named_endpoint(const RemoteArguments& arguments) {
  std::string text = arguments.server;
  if (text.empty()) text = from_environment("ENGRAM_SERVER");
  if (text.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const Endpoint usual, server::default_endpoint());
    text = usual.to_string();
  }
  ENGRAM_ASSIGN_OR_RETURN(const Endpoint endpoint, Endpoint::parse(text));
  if (!is_there(endpoint)) return unavailable("no server listens at '{}'", text);
  return text;
}

Result<std::vector<Registration>> known_servers(const RemoteArguments& arguments,
                                                const std::string& memory) {
  ENGRAM_ASSIGN_OR_RETURN(const auto options, client_options(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const auto names, server::NamesClient::connect(arguments.names, options));
  ENGRAM_ASSIGN_OR_RETURN(auto servers, names->resolve(memory));
  if (servers.empty() && !memory.empty())
    return not_found("the name system at '{}' knows no server of '{}'", arguments.names, memory);
  return servers;
}

Result<std::vector<std::unique_ptr<MemoryClient>>> open_clients(
    const RemoteArguments& arguments, const std::vector<std::string>& memories) {
  ENGRAM_ASSIGN_OR_RETURN(const auto options, client_options(arguments));
  std::vector<std::string> endpoints;
  if (arguments.names.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(endpoints.emplace_back(), named_endpoint(arguments));
  } else {
    std::set<std::string> seen;
    for (const std::string& memory : memories) {
      ENGRAM_ASSIGN_OR_RETURN(const auto servers, known_servers(arguments, memory));
      for (const Registration& registration : servers) {
        if (!seen.insert(registration.server).second) continue;
        ENGRAM_ASSIGN_OR_RETURN(endpoints.emplace_back(), reachable(registration));
      }
    }
    if (endpoints.empty())
      return not_found("the name system at '{}' knows no server", arguments.names);
  }
  std::vector<std::unique_ptr<MemoryClient>> clients;
  for (const std::string& endpoint : endpoints) {
    ENGRAM_ASSIGN_OR_RETURN(clients.emplace_back(), MemoryClient::connect(endpoint, options));
  }
  return clients;
}

Result<std::unique_ptr<MemoryClient>> open_client(const RemoteArguments& arguments,
                                                  const std::string& memory) {
  ENGRAM_ASSIGN_OR_RETURN(auto clients, open_clients(arguments, {memory}));
  return std::move(clients.front());
}

}  // namespace engram::cli
