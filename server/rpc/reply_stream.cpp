// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/reply_stream.h"

#include "server/wire/wire_status.h"

namespace engram::server {

void ReplyStream::begin() {
  self_ = shared_from_this();
  {
    const MutexLock lock(mutex_);
    is_reading_ = true;
  }
  StartRead(&request_);
}

void ReplyStream::OnReadDone(bool ok) {
  Status status;
  if (ok) status = on_request(request_);
  request_.Clear();
  const MutexLock lock(mutex_);
  is_reading_ = false;
  if (!status.ok() && status_.ok()) status_ = std::move(status);
  if (!ok || !status_.ok()) is_read_to_end_ = true;
  go_on();
}

void ReplyStream::OnWriteDone(bool ok) {
  {
    const MutexLock lock(mutex_);
    is_writing_ = false;
    written_.Clear();
    if (!ok) is_broken_ = true;
    go_on();
  }
  on_sent();
}

void ReplyStream::OnCancel() {
  const MutexLock lock(mutex_);
  is_broken_ = true;
  go_on();
}

void ReplyStream::OnDone() {
  on_end();
  self_.reset();
}

void ReplyStream::promise() {
  const MutexLock lock(mutex_);
  ++promised_;
}

void ReplyStream::fulfil() {
  const MutexLock lock(mutex_);
  --promised_;
  go_on();
}

void ReplyStream::send(grpc::ByteBuffer reply) {
  const MutexLock lock(mutex_);
  if (is_broken_ || is_finished_) return;
  waiting_bytes_ += reply.Length();
  waiting_.push_back(std::move(reply));
  go_on();
}

bool ReplyStream::has_room(size_t max_bytes) {
  const MutexLock lock(mutex_);
  return !is_broken_ && !is_finished_ && waiting_.size() < kMaxReplies &&
         waiting_bytes_ < max_bytes;
}

void ReplyStream::end(const Status& status) {
  const MutexLock lock(mutex_);
  if (status_.ok()) status_ = status;
  is_read_to_end_ = true;
  go_on();
}

/// Starts every operation that can start now: a write, a read, or the end.
void ReplyStream::go_on() {
  if (is_finished_) return;
  if (is_broken_) {
    waiting_.clear();
    waiting_bytes_ = 0;
    is_read_to_end_ = true;
  }
  const bool writes = !is_writing_ && !waiting_.empty();
  if (writes) {
    is_writing_ = true;
    written_ = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= written_.Length();
  }
  const bool reads = !is_reading_ && !is_read_to_end_ && promised_ < kMaxReplies &&
                     waiting_.size() < kMaxReplies && waiting_bytes_ < kMaxReplyBytes;
  if (reads) is_reading_ = true;
  const bool ends = is_read_to_end_ && !is_reading_ && !is_writing_ && waiting_.empty() &&
                    (promised_ == 0 || is_broken_);
  // A stream that ends with an error does not wait for requests that may never come.
  const bool is_cut = is_read_to_end_ && is_reading_ && !is_writing_ && waiting_.empty() &&
                      (promised_ == 0 || is_broken_) && !status_.ok();
  if (ends || is_cut) is_finished_ = true;
  // Operations begin with the lock held, because nothing may begin after Finish().
  if (writes) StartWrite(&written_);
  if (reads) StartRead(&request_);
  if (ends || is_cut) Finish(is_broken_ ? grpc::Status::CANCELLED : to_grpc(status_));
}

}  // namespace engram::server
