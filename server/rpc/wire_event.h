// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "server/events/event_hub.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

/// A commit's snapshot in the forms in which subscribers want it, each made once.
///
/// Threading: thread-safe.
class WireEvent final : public CommitEvent {
 public:
  using CommitEvent::CommitEvent;

  const WireBytes& with_data() {
    std::call_once(data_made_, [this] { data_ = to_wire(*snapshot, true); });
    return data_;
  }
  const WireBytes& ids_only() {
    std::call_once(ids_made_, [this] { ids_ = to_wire(*snapshot, false); });
    return ids_;
  }

 private:
  std::once_flag data_made_;
  std::once_flag ids_made_;
  WireBytes data_;
  WireBytes ids_;
};

}  // namespace engram::server
