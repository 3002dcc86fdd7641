// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "server/access/endpoint.h"

namespace engram::server {

/// Decides whether a server may listen on an endpoint.
///
/// An endpoint that only this machine can reach needs nothing, and is used without TLS. Any other
/// endpoint needs a certificate, its key and a tokens file; no option disables that.
/// Threading: immutable, const-parallel.
/// Source: docs/access.md.
class ListenPolicy {
 public:
  /// Paths of files; an empty path means that there is none.
  struct Options {
    /// PEM: the server's certificate, then those of the authorities that signed it.
    std::filesystem::path certificate;
    std::filesystem::path key;  ///< PEM; readable by its owner and group at most.
    /// PEM; if set, clients need a certificate that this authority signed.
    std::filesystem::path client_ca;
    std::filesystem::path tokens;  ///< See AccessPolicy; readable by its owner and group at most.
  };

  explicit ListenPolicy(Options options) : options_(std::move(options)) {}

  /// Errors: kFailedPrecondition listing everything that is missing: files that are not named, do
  /// not exist, or can be read by others.
  [[nodiscard]] Status check(const Endpoint& endpoint) const;

  /// Checks all endpoints; the message has a line for each one that is refused.
  [[nodiscard]] Status check(const std::vector<Endpoint>& endpoints) const;

  /// Checks the files that are named, whether or not an endpoint needs them: who names a file wants
  /// it to count. Errors: those of check_certificates, check_key_of and check_private_file.
  [[nodiscard]] Status check_files() const;

  /// Whether servers and clients use TLS at an endpoint.
  [[nodiscard]] static bool needs_tls(const Endpoint& endpoint) { return !endpoint.is_local(); }

  [[nodiscard]] const Options& options() const { return options_; }

 private:
  [[nodiscard]] std::vector<std::string> missing() const;

  Options options_;
};

}  // namespace engram::server
