// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "server/access/endpoint.h"

namespace engram::server {

/// Whether an endpoint may be listened on.
///
/// What only this machine can reach needs nothing, and is spoken to without TLS. Anything else
/// needs a certificate, its key and a tokens file; there is no option to do without.
/// Threading: immutable, const-parallel.
/// Source: docs/access.md.
class ListenPolicy {
 public:
  /// Files; an empty path: there is none.
  struct Options {
    std::filesystem::path certificate;  ///< PEM, the server's first, then those that vouch for it.
    std::filesystem::path key;          ///< PEM; nobody else may read it.
    std::filesystem::path client_ca;    ///< PEM; clients need a certificate that it vouches for.
    std::filesystem::path tokens;       ///< See AccessPolicy; nobody else may read it.
  };

  explicit ListenPolicy(Options options) : options_(std::move(options)) {}

  /// Errors: kFailedPrecondition with everything that is missing: files that are not named, are not
  /// there, or can be read by others.
  [[nodiscard]] Status check(const Endpoint& endpoint) const;

  /// All of them; the message has a line for each that may not be listened on.
  [[nodiscard]] Status check(const std::vector<Endpoint>& endpoints) const;

  /// True where servers and clients speak TLS.
  [[nodiscard]] static bool needs_tls(const Endpoint& endpoint) { return !endpoint.is_local(); }

  [[nodiscard]] const Options& options() const { return options_; }

 private:
  [[nodiscard]] std::vector<std::string> missing() const;

  Options options_;
};

}  // namespace engram::server
