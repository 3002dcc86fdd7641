// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include "server/sharing/block_ref.h"

namespace engram::server {

[[nodiscard]] BlockRef to_block(const v1::Block& message);
[[nodiscard]] v1::Block to_message(const BlockRef& block);

}  // namespace engram::server
