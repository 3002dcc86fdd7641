// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/byte_buffer.h>

#include "ltm/core/log.h"
#include "ltm/core/status.h"

namespace engram::server {

template <typename Message>
[[nodiscard]] grpc::ByteBuffer to_bytes(const Message& message) {
  grpc::ByteBuffer bytes;
  bool is_owned = false;
  // Serialization fails only for messages above 2 GB, which are never built.
  if (!grpc::SerializationTraits<Message>::Serialize(message, &bytes, &is_owned).ok())
    log::warning("a {} of {} bytes is too large to be sent", message.GetTypeName(),
                 message.ByteSizeLong());
  return bytes;
}

/// Parses a message; safe on hostile bytes.
/// Errors: kInvalidArgument.
template <typename Message>
Status read_message(grpc::ByteBuffer& bytes, Message& message) {
  const size_t length = bytes.Length();
  if (!grpc::SerializationTraits<Message>::Deserialize(&bytes, &message).ok())
    return invalid_argument("found {} bytes that are no {}", length, message.GetTypeName());
  return {};
}

}  // namespace engram::server
