// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/caller.h"

namespace engram::server {

Result<Identity> caller(const AccessPolicy& access, const grpc::ServerContextBase& context) {
  constexpr std::string_view kScheme = "Bearer ";
  const auto& metadata = context.client_metadata();
  const auto found = metadata.find("authorization");
  if (found == metadata.end()) return access.authenticate({});
  std::string_view value(found->second.data(), found->second.size());
  if (!value.starts_with(kScheme))
    return failed_precondition("authorization: needs 'Bearer TOKEN'");
  return access.authenticate(value.substr(kScheme.size()));
}

}  // namespace engram::server
