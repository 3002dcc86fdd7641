// SPDX-License-Identifier: Apache-2.0
#include "server/access/listen_policy.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include "ltm/core/private_file.h"
#include "server/access/certificate.h"

namespace engram::server {

namespace {

using std::filesystem::path;

Status check_public_file(const path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    return not_found("'{}': there is no such file", file.string());
  if (::access(file.c_str(), R_OK) != 0) return unavailable("'{}': cannot be read", file.string());
  return {};
}

void note_missing(std::vector<std::string>& missing, std::string_view what, const path& file,
                  Status (*check)(const path&)) {
  if (file.empty()) {
    missing.push_back(fmt::format("{}: not named", what));
    return;
  }
  if (const Status status = check(file); !status.ok())
    missing.push_back(fmt::format("{}: {}", what, status.message()));
}

}  // namespace

std::vector<std::string> ListenPolicy::missing() const {
  std::vector<std::string> missing;
  note_missing(missing, "TLS certificate", options_.certificate, check_public_file);
  note_missing(missing, "TLS key", options_.key, check_private_file);
  if (!options_.client_ca.empty())
    note_missing(missing, "CA of clients", options_.client_ca, check_public_file);
  note_missing(missing, "tokens file", options_.tokens, check_private_file);
  return missing;
}

Status ListenPolicy::check_files() const {
  if (!options_.certificate.empty())
    ENGRAM_RETURN_IF_ERROR(check_certificates(options_.certificate));
  if (!options_.client_ca.empty()) ENGRAM_RETURN_IF_ERROR(check_certificates(options_.client_ca));
  if (!options_.key.empty()) {
    ENGRAM_RETURN_IF_ERROR(check_private_file(options_.key));
    if (options_.certificate.empty())
      return invalid_argument("key '{}': is named without its certificate", options_.key.string());
    ENGRAM_RETURN_IF_ERROR(check_key_of(options_.certificate, options_.key));
  }
  return options_.tokens.empty() ? Status() : check_private_file(options_.tokens);
}

Status ListenPolicy::check(const Endpoint& endpoint) const {
  if (endpoint.is_local()) return {};
  const std::vector<std::string> missing = this->missing();
  if (missing.empty()) return {};
  return failed_precondition(
      "endpoint '{}': other machines can reach it, which needs a certificate, its key and a tokens "
      "file; missing are: {}",
      endpoint.to_string(), fmt::join(missing, "; "));
}

Status ListenPolicy::check(const std::vector<Endpoint>& endpoints) const {
  std::vector<std::string> refusals;
  for (const Endpoint& endpoint : endpoints)
    if (const Status status = check(endpoint); !status.ok()) refusals.push_back(status.message());
  if (refusals.empty()) return {};
  return failed_precondition("{}", fmt::join(refusals, "\n"));
}

}  // namespace engram::server
