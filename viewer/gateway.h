// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "ltm/core/time.h"
#include "viewer/http_message.h"

namespace engram::viewer {

/// Speaks HTTP/1.1 with browsers. What the answers are it does not know.
///
/// One thread reads and writes for all connections, a few workers make answers. Everything that a
/// stranger could use up is bounded: connections, the bytes of a request, the time that it takes to
/// arrive, and how many requests wait for a worker.
/// Threading: one thread; the handler is called by workers, several at a time.
class Gateway {
 public:
  struct Options {
    std::string address = "127.0.0.1";                  ///< Of this machine, as numbers.
    uint16_t port = 0;                                  ///< 0: any.
    size_t max_connections = 256;                       ///< Further ones are closed at once.
    size_t workers = 8;                                 ///< Some wait for long questions.
    size_t max_waiting = 256;                           ///< Further requests are answered with 503.
    size_t max_header_bytes = 80 << 10;                 ///< Longer requests are answered with 431.
    Duration first_request = std::chrono::seconds(10);  ///< Until it is there whole.
    Duration next_request = std::chrono::seconds(60);   ///< The same, on a used connection.
    Duration write = std::chrono::seconds(30);          ///< Until an answer is taken whole.
    size_t max_sockets = 32;        ///< WebSockets; further ones are answered with 503.
    size_t max_socket_frames = 64;  ///< That wait for a slow browser; older ones are dropped.
  };

  /// Listens, so that the port is known. Nobody is served yet.
  /// Errors: kInvalidArgument if the address is none; kUnavailable if it cannot be listened at.
  static Result<std::unique_ptr<Gateway>> listen(const Options& options);

  /// Stops, after the answers that are being made.
  ~Gateway();

  [[nodiscard]] uint16_t port() const;

  /// Makes the answer to a request. It must not throw.
  using Handle = std::function<HttpResponse(const HttpRequest&)>;

  /// Whether a WebSocket may be opened by a request; else the answer to it. It must not throw.
  using Admit = std::function<std::optional<HttpResponse>(const HttpRequest&)>;

  /// Serves until this object ends. Call it once.
  void serve(Handle handle, Admit admit);

  /// Sends a text to all open WebSockets. To one that is too slow, the oldest that wait are not
  /// sent, and {"kind": "dropped", "count": n} tells it how many snapshots they told of.
  /// Threading: thread-safe.
  void publish(std::string text, uint64_t snapshots);

 private:
  struct State;
  explicit Gateway(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::viewer
