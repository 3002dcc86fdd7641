// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::server {

/// The client of a Memory Name System, for servers and for clients. Each call blocks until the
/// answer arrives.
///
/// Threading: thread-safe.
class NamesClient {
 public:
  /// Creates a client without waiting for the name system.
  /// Errors: those of MemoryClient::connect.
  static Result<std::unique_ptr<NamesClient>> connect(const std::string& endpoint,
                                                      const ClientOptions& options = {});
  ~NamesClient();

  /// Registers a server and returns the interval at which it must send heartbeats.
  /// Errors: those of NameRegistry; kUnavailable if the name system cannot be reached.
  Result<Duration> add(const Registration& registration);
  /// Renews the registration of a server. See NameRegistry::heartbeat.
  Status heartbeat(const std::string& server, uint64_t incarnation);
  /// Removes the registration of a server. See NameRegistry::remove.
  Status remove(const std::string& server, uint64_t incarnation);

  /// Returns the servers that have `memory`, which is a name or a regular expression; empty returns
  /// all servers. With `wait`, a call for a name that no server has yet blocks until the first
  /// server registers it, for `wait` at most.
  Result<std::vector<Registration>> resolve(const std::string& memory, Duration wait = {});

 private:
  struct State;
  explicit NamesClient(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Keeps a server registered as long as this object lives, even if the name system restarts.
///
/// Owns: one thread, which sends heartbeats.
/// Threading: one thread.
class Registrar {
 public:
  /// `names` must outlive this object.
  Registrar(NamesClient& names, Registration registration);
  /// Removes the registration.
  ~Registrar();

  [[nodiscard]] bool is_registered() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
