// SPDX-License-Identifier: Apache-2.0
#include "cli/remote.h"

namespace engram::cli {

Result<std::unique_ptr<Memory>> open_memory(const std::string& store, const OpenOptions& options,
                                            const RemoteArguments& arguments) {
  return store.empty() ? connect_memory(arguments) : Memory::open(store, options);
}

}  // namespace engram::cli
