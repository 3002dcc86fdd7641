// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/rpc_server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <mutex>

#include "ltm/core/file.h"
#include "server/rpc/connection_guard.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

namespace {

/// Removes a socket file without a listener, which `kill -9` leaves behind.
Status make_room(const std::string& path) {
  struct stat about {};
  if (::lstat(path.c_str(), &about) != 0) return {};
  if (!S_ISSOCK(about.st_mode))
    return failed_precondition("endpoint 'unix:{}': found a file that is no socket", path);
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return unavailable("endpoint 'unix:{}': {}", path, std::strerror(errno));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  const bool is_alive =
      ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  ::close(probe);
  if (is_alive)
    return failed_precondition("endpoint 'unix:{}': another server listens there", path);
  ::unlink(path.c_str());
  return {};
}

Result<std::shared_ptr<grpc::ServerCredentials>> credentials(const Endpoint& endpoint,
                                                             const ListenPolicy& policy) {
  if (!ListenPolicy::needs_tls(endpoint)) return grpc::InsecureServerCredentials();
  const ListenPolicy::Options& files = policy.options();
  grpc::SslServerCredentialsOptions options(
      files.client_ca.empty() ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                              : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  ENGRAM_ASSIGN_OR_RETURN(const auto certificate, read_file(files.certificate));
  ENGRAM_ASSIGN_OR_RETURN(const auto key, read_file(files.key));
  options.pem_key_cert_pairs.push_back(
      {std::string(as_text(key.bytes())), std::string(as_text(certificate.bytes()))});
  if (!files.client_ca.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto ca, read_file(files.client_ca));
    options.pem_root_certs = std::string(as_text(ca.bytes()));
  }
  return grpc::SslServerCredentials(options);
}

}  // namespace

/// The bound of what gRPC keeps of what came and was not handed over yet: several of the largest
/// messages. Beyond it gRPC ends streams and connections. Unit: bytes.
size_t received_bytes(const RpcServer::Options& options) {
  constexpr size_t kMin = size_t{128} << 20;
  constexpr size_t kMessages = 3;
  return std::max(kMin, kMessages * static_cast<size_t>(options.max_message_bytes));
}

struct RpcServer::State {
  Options options;
  std::unique_ptr<grpc::Server> server;
  std::vector<int> ports;
  std::shared_ptr<ConnectionGuard> guard = ConnectionGuard::of_process();
};

RpcServer::RpcServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

RpcServer::~RpcServer() {
  stop(Duration(0));
}

Result<std::unique_ptr<RpcServer>> RpcServer::start(const Options& options,
                                                    const std::vector<grpc::Service*>& services) {
  if (options.endpoints.empty())
    return invalid_argument("server: found no endpoint to listen on, needs one");
  const ListenPolicy policy(options.security);
  ENGRAM_RETURN_IF_ERROR(policy.check(options.endpoints));
  ENGRAM_RETURN_IF_ERROR(policy.check_files());
  static std::once_flag once;
  std::call_once(once, [] {
    grpc::EnableDefaultHealthCheckService(true);
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  });
  PollingThreads::of_process();
  auto state = std::make_unique<State>();
  state->options = options;
  state->ports.resize(options.endpoints.size());
  grpc::ServerBuilder builder;
  for (size_t i = 0; i < options.endpoints.size(); ++i) {
    const Endpoint& endpoint = options.endpoints[i];
    if (endpoint.kind() == Endpoint::Kind::kUnix)
      ENGRAM_RETURN_IF_ERROR(make_room(endpoint.path()));
    ENGRAM_ASSIGN_OR_RETURN(auto security, credentials(endpoint, policy));
    builder.AddListeningPort(endpoint.to_string(), std::move(security), &state->ports[i]);
  }
  builder.SetMaxReceiveMessageSize(options.max_message_bytes);
  builder.SetMaxSendMessageSize(-1);
  builder.SetResourceQuota(grpc::ResourceQuota("engram").Resize(received_bytes(options)));
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, options.max_streams_per_connection);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // ConnectionGuard reads its counts, whatever GRPC_ENABLE_CHANNELZ says.
  builder.AddChannelArgument(GRPC_ARG_ENABLE_CHANNELZ, 1);
  // A peer that connects and stays silent costs a descriptor; this limits for how long.
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, 10'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 20'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 10'000);
  // Clients send a keepalive ping every 2 s, even without calls. Without this setting the server
  // would disconnect them for that, and they would ping less and less often.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 1'000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  for (grpc::Service* service : services) builder.RegisterService(service);
  state->server = builder.BuildAndStart();
  for (size_t i = 0; i < options.endpoints.size(); ++i)
    if (!state->server || state->ports[i] == 0)
      return unavailable("endpoint '{}': cannot be listened on", options.endpoints[i].to_string());
  // Write permission on the socket decides who may connect: its owner and group.
  for (const Endpoint& endpoint : options.endpoints)
    if (endpoint.kind() == Endpoint::Kind::kUnix) ::chmod(endpoint.path().c_str(), 0660);
  return std::unique_ptr<RpcServer>(new RpcServer(std::move(state)));
}

std::vector<std::string> RpcServer::endpoints() const {
  std::vector<std::string> all;
  for (size_t i = 0; i < state_->options.endpoints.size(); ++i) {
    const Endpoint& endpoint = state_->options.endpoints[i];
    if (endpoint.kind() == Endpoint::Kind::kUnix || endpoint.port() != 0) {
      all.push_back(endpoint.to_string());
      continue;
    }
    const std::string host = endpoint.host().find(':') != std::string::npos
                                 ? fmt::format("[{}]", endpoint.host())
                                 : endpoint.host();
    all.push_back(fmt::format("{}:{}", host, state_->ports[i]));
  }
  return all;
}

void RpcServer::stop(Duration grace) {
  if (!state_->server) return;
  state_->server->Shutdown(std::chrono::system_clock::now() + grace);
  state_->server->Wait();
  state_->server.reset();
}

}  // namespace engram::server
