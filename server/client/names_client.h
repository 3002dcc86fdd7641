// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/client/memory_client.h"
#include "server/names/registration.h"

namespace engram::server {

/// The Memory Name System, as servers and clients use it. Each call waits for the answer.
///
/// Threading: thread-safe.
class NamesClient {
 public:
  /// Does not wait for the name system.
  /// Errors: as MemoryClient::connect.
  static Result<std::unique_ptr<NamesClient>> connect(const std::string& endpoint,
                                                      const ClientOptions& options = {});
  ~NamesClient();

  /// Errors: those of NameRegistry; kUnavailable.
  Result<Duration> add(const Registration& registration);
  Status heartbeat(const std::string& server, uint64_t incarnation);
  Status remove(const std::string& server, uint64_t incarnation);

  /// The servers of memories: a name or a regular expression; empty: all. With `wait`, waits for
  /// the first one of a name that nobody has yet.
  Result<std::vector<Registration>> resolve(const std::string& memory, Duration wait = {});

 private:
  struct State;
  explicit NamesClient(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Keeps a server registered as long as it lives, also when the name system starts over.
///
/// Owns: a thread.
/// Threading: one thread.
class Registrar {
 public:
  /// `names` outlives it.
  Registrar(NamesClient& names, Registration registration);
  /// Says that the server leaves.
  ~Registrar();

  [[nodiscard]] bool is_registered() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::server
