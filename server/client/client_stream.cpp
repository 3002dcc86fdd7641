// SPDX-License-Identifier: Apache-2.0
#include "server/client/client_stream.h"

#include <grpcpp/channel.h>

#include "server/wire/wire_status.h"

namespace engram::server {

std::shared_ptr<void> OpenStreams::enter() {
  {
    const MutexLock lock(state_->mutex);
    ++state_->count;
  }
  const auto leave = [state = state_](void*) {
    const MutexLock lock(state->mutex);
    --state->count;
    state->changed.notify_all();
  };
  return {nullptr, leave};
}

void OpenStreams::wait() {
  const MutexLock lock(state_->mutex);
  state_->changed.wait(state_->mutex,
                       [this]() ENGRAM_REQUIRES(state_->mutex) { return state_->count == 0; });
}

std::shared_ptr<ClientStream> ClientStream::open(const std::shared_ptr<grpc::Channel>& channel,
                                                 const std::string& method,
                                                 const std::string& token, OpenStreams& streams,
                                                 Handlers handlers, const std::string& session) {
  const std::shared_ptr<ClientStream> stream(new ClientStream(streams, std::move(handlers)));
  stream->self_ = stream;
  if (!token.empty()) stream->context_.AddMetadata("authorization", "Bearer " + token);
  if (!session.empty()) stream->context_.AddMetadata("engram-session", session);
  grpc::GenericStub stub{std::shared_ptr<grpc::ChannelInterface>(channel)};
  stub.PrepareBidiStreamingCall(&stream->context_, method, {}, stream.get());
  // Any thread may write at any time. Without a hold, the call could end before a write begins.
  stream->AddHold();
  stream->StartRead(&stream->reply_);
  stream->StartCall();
  return stream;
}

Status ClientStream::send(grpc::ByteBuffer request) {
  // The write begins with the lock held, because gRPC forbids new operations once the hold is
  // removed.
  const MutexLock lock(mutex_);
  if (!is_open_) return unavailable("the stream has ended");
  if (is_writing_) {
    waiting_.push_back(std::move(request));
    return {};
  }
  written_ = std::move(request);
  is_writing_ = true;
  StartWrite(&written_);
  return {};
}

bool ClientStream::is_open() const {
  const MutexLock lock(mutex_);
  return is_open_;
}

void ClientStream::cancel() {
  context_.TryCancel();
}

void ClientStream::OnReadDone(bool ok) {
  if (ok) {
    handlers_.on_reply(reply_);
    reply_.Clear();
    StartRead(&reply_);
    return;
  }
  {
    const MutexLock lock(mutex_);
    is_open_ = false;
    waiting_.clear();
  }
  // A failed read means that the call has ended, so the hold that kept it open is released.
  RemoveHold();
}

void ClientStream::OnWriteDone(bool ok) {
  const MutexLock lock(mutex_);
  is_writing_ = false;
  if (!ok || !is_open_ || waiting_.empty()) return;
  written_ = std::move(waiting_.front());
  waiting_.pop_front();
  is_writing_ = true;
  StartWrite(&written_);
}

void ClientStream::OnDone(const grpc::Status& status) {
  const auto kept = std::move(self_);
  handlers_.on_end(status.ok() ? unavailable("the server ended the stream") : to_status(status));
}

}  // namespace engram::server
