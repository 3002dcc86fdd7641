// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_context.h"

#include "ltm/context/stored_context.h"

namespace engram::server {

Result<v1::EntityContext> to_message(const ltm::MemoryId& entity,
                                     const ltm::SharedContext& context) {
  v1::EntityContext message;
  message.set_entity(entity.to_string());
  if (!context) return message;
  const auto bytes = ltm::pack_contexts({{entity, *context}});
  if (bytes.size() > kMaxContextBytes)
    return resource_exhausted(
        "'{}': its places and links take {} bytes, and at most {} go to another server",
        entity.to_string(), bytes.size(), kMaxContextBytes);
  message.set_context(bytes.data(), bytes.size());
  return message;
}

Result<std::shared_ptr<const ltm::OtherContexts>> to_contexts(
    const google::protobuf::RepeatedPtrField<v1::EntityContext>& messages) {
  ltm::OtherContexts contexts;
  size_t bytes = 0;
  for (const v1::EntityContext& message : messages) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, ltm::MemoryId::parse(message.entity()));
    if (!message.has_context()) continue;
    bytes += message.context().size();
    if (!entity.is_entity() || bytes > kMaxContextBytes)
      return invalid_argument(
          "context of '{}': found {} bytes in all, needs an entity and at most {}",
          message.entity(), bytes, kMaxContextBytes);
    ENGRAM_ASSIGN_OR_RETURN(auto context,
                            ltm::unpack_context(std::as_bytes(std::span(message.context())), entity,
                                                kMaxUnpackedContextBytes));
    if (context) contexts[entity] = std::make_shared<const ltm::EntityContext>(*std::move(context));
  }
  return std::make_shared<const ltm::OtherContexts>(std::move(contexts));
}

}  // namespace engram::server
