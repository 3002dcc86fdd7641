// SPDX-License-Identifier: Apache-2.0
// Replaces the client of servers where there is no gRPC.
#include "memory/memory.h"

namespace engram {

Result<std::unique_ptr<Memory>> Memory::connect(const std::string& endpoint,
                                                const ConnectOptions& /*options*/) {
  return failed_precondition("'{}': this program was built without servers", endpoint);
}

}  // namespace engram
