// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "server/rpc/reply_stream.h"
#include "server/rpc/rpc_context.h"
#include "server/skills/provider_link.h"

namespace engram::v1 {
class ProvideRequest;
}

namespace engram::server {

/// The stream of one provider of skills: what it has and reports goes to the skill memory, and what
/// it is to execute comes back. The provider is gone when the stream ends.
class ProvideStream final : public ReplyStream {
 public:
  ProvideStream(RpcContext& context, Identity who, ClientId /*sharing*/)
      : context_(context), who_(std::move(who)) {}

 private:
  class Link;

  Status on_request(grpc::ByteBuffer& request) override;
  void on_end() override;
  Status check();
  Status hello(const v1::ProvideRequest& message);

  RpcContext& context_;
  const Identity who_;
  const StreamSlot slot_{context_, who_};
  skills::SkillMemory* skills_ = nullptr;  ///< Null until the provider has said who it is.
  uint64_t session_ = 0;
};

}  // namespace engram::server
