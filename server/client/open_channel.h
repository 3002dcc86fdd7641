// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <functional>
#include <future>
#include <memory>

#include "server/access/endpoint.h"
#include "server/client/client_options.h"
#include "server/wire/polling_threads.h"

namespace engram::server {

/// Returns a channel that connects when it is first used, and reconnects after the connection
/// broke.
/// Errors: those of reading the CA file.
Result<std::shared_ptr<grpc::Channel>> open_channel(const Endpoint& endpoint,
                                                    const ClientOptions& options);

/// Makes a call through a stub's async interface and blocks until it ends. gRPC's own threads then
/// drive the connection all the time. A blocking call would drive it only while the call lasts, so
/// calls that fail at once, again and again, would never complete a TLS handshake.
template <typename Async, typename Request, typename Reply>
grpc::Status wait_for_call(Async* async,
                           void (Async::*method)(grpc::ClientContext*, const Request*, Reply*,
                                                 std::function<void(grpc::Status)>),
                           grpc::ClientContext& context, const Request& request, Reply& reply) {
  const auto ended = std::make_shared<std::promise<grpc::Status>>();
  const BlockingScope blocking;
  (async->*method)(&context, &request, &reply,
                   [ended](grpc::Status status) { ended->set_value(std::move(status)); });
  return ended->get_future().get();
}

}  // namespace engram::server
