// SPDX-License-Identifier: Apache-2.0
#include "server/client/open_channel.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include "ltm/core/file.h"
#include "server/access/certificate.h"
#include "server/access/listen_policy.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

Result<std::shared_ptr<grpc::Channel>> open_channel(const Endpoint& endpoint,
                                                    const ClientOptions& options) {
  PollingThreads::of_process();
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(options.max_message_bytes);
  arguments.SetMaxSendMessageSize(options.max_message_bytes);
  // A short backoff finds a server that restarts, or a network that comes back, within a second.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 50);
  // gRPC uses this value as the timeout of one connection attempt. The TLS handshake of a busy
  // machine needs more time than the wait between two attempts.
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 2000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 500);
  // Keepalive pings detect within seconds a server that vanished without closing its connection.
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 2000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 2000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // Each client has its own connection, so that a call that waits does not hold up another client.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  std::shared_ptr<grpc::ChannelCredentials> credentials = grpc::InsecureChannelCredentials();
  if (!options.ca.empty()) ENGRAM_RETURN_IF_ERROR(check_certificates(options.ca));
  if (ListenPolicy::needs_tls(endpoint)) {
    grpc::SslCredentialsOptions tls;
    if (!options.ca.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(const Buffer ca, read_file(options.ca));
      tls.pem_root_certs = std::string(as_text(ca.bytes()));
    }
    credentials = grpc::SslCredentials(tls);
  }
  return grpc::CreateCustomChannel(endpoint.to_string(), credentials, arguments);
}

}  // namespace engram::server
