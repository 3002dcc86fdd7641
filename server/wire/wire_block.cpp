// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_block.h"

namespace engram::server {

BlockRef to_block(const v1::Block& message) {
  return {message.slab(), message.offset(), message.capacity(), message.generation()};
}

v1::Block to_message(const BlockRef& block) {
  v1::Block message;
  message.set_slab(block.slab);
  message.set_offset(block.offset);
  message.set_capacity(block.capacity);
  message.set_generation(block.generation);
  return message;
}

}  // namespace engram::server
