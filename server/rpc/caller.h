// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/server_context.h>

#include "server/access/access_policy.h"

namespace engram::server {

/// Identifies a caller by the token in its metadata ("authorization: Bearer TOKEN").
/// Errors: kFailedPrecondition if the token is missing or unknown.
Result<Identity> caller(const AccessPolicy& access, const grpc::ServerContextBase& context);

}  // namespace engram::server
