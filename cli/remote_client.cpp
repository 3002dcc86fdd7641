// SPDX-License-Identifier: Apache-2.0
#include "cli/remote_client.h"

#include <stdlib.h>

#include <cstdlib>
#include <filesystem>

#include "ltm/core/file.h"
#include "server/access/default_endpoint.h"
#include "server/client/names_client.h"

namespace engram::cli {

using server::Endpoint;
using server::MemoryClient;

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

/// Returns token, CA and timeout of the arguments and the environment (ENGRAM_TOKEN).
Result<ConnectOptions> connect_options(const RemoteArguments& arguments) {
  // Failures come back as a status; gRPC would also print each failed try on stderr.
  ::setenv("GRPC_VERBOSITY", "NONE", 0);
  ConnectOptions options;
  options.is_name_system = !arguments.names.empty();
  options.token = from_environment("ENGRAM_TOKEN");
  if (!arguments.token.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const Buffer text, read_file(arguments.token));
    options.token = as_text(text.bytes());
    // Editors end a file with a line break, which is no part of the token.
    options.token.erase(options.token.find_last_not_of("\r\n") + 1);
  }
  options.ca = arguments.ca;
  ENGRAM_ASSIGN_OR_RETURN(options.timeout, parse_duration(arguments.timeout));
  return options;
}

Result<server::ClientOptions> client_options(const RemoteArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const ConnectOptions options, connect_options(arguments));
  server::ClientOptions client;
  client.token = options.token;
  client.ca = options.ca;
  client.timeout = options.timeout;
  return client;
}

/// Returns the endpoint of --server, else of ENGRAM_SERVER, else the default one.
/// Errors: kInvalidArgument; kUnavailable if the socket does not exist.
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

Result<Connection> connection_of(const RemoteArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const ConnectOptions options, connect_options(arguments));
  if (options.is_name_system) return Connection{arguments.names, options};
  ENGRAM_ASSIGN_OR_RETURN(const std::string endpoint, named_endpoint(arguments));
  return Connection{endpoint, options};
}

Result<std::unique_ptr<Memory>> connect_memory(const RemoteArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const Connection connection, connection_of(arguments));
  return Memory::connect(connection.endpoint, connection.options);
}

Result<std::vector<server::Registration>> known_servers(const RemoteArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const auto options, client_options(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const auto names, server::NamesClient::connect(arguments.names, options));
  return names->resolve("");
}

Result<std::unique_ptr<MemoryClient>> open_client(const RemoteArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const auto options, client_options(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const std::string endpoint, named_endpoint(arguments));
  return MemoryClient::connect(endpoint, options);
}

}  // namespace engram::cli
