// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sharing_client.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <unordered_map>

#include "ltm/core/mutex.h"
#include "server/sharing/channel.h"
#include "server/sharing/listening_socket.h"
#include "server/sharing/slab.h"

namespace engram::server {

namespace {

/// The blocks of destroyed Buffers. It is shared, because Buffers may outlive the client.
struct Released {
  Mutex mutex;
  std::vector<BlockRef> blocks ENGRAM_GUARDED_BY(mutex);
};

/// Keeps the mapping that a Buffer views, and reports when the Buffer is destroyed.
struct Reading {
  Reading(std::shared_ptr<Mapping> mapped, BlockRef read, std::shared_ptr<Released> queue,
          SharingClient::OnRelease callback)
      : mapping(std::move(mapped)),
        block(read),
        released(std::move(queue)),
        on_release(std::move(callback)) {}
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading() {
    if (on_release) {
      on_release(block);
      return;
    }
    const MutexLock lock(released->mutex);
    released->blocks.push_back(block);
  }

  std::shared_ptr<Mapping> mapping;
  BlockRef block;
  std::shared_ptr<Released> released;
  SharingClient::OnRelease on_release;
};

Status gone() {
  return unavailable("sharing: the server is gone");
}

Status refused(const Message& message, std::string_view what) {
  const StatusCode code = status_code(message);
  if (code == StatusCode::kOk) return {};
  return {code, fmt::format("sharing: the server refused {}", what)};
}

Status check_server(int socket, const SharingClient::Options& options) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0)
    return system_status("sharing: cannot tell whose server it is");
  const bool is_trusted =
      peer.uid == ::geteuid() || peer.uid == 0 ||
      std::ranges::find(options.other_uids, peer.uid) != options.other_uids.end();
  if (is_trusted) return {};
  return failed_precondition("sharing: the server is of user {}, needs one that is trusted",
                             peer.uid);
}

Status greet(int socket, const Ticket& ticket) {
  Message hello;
  hello.kind = Message::Kind::kHello;
  hello.ticket = ticket;
  ENGRAM_RETURN_IF_ERROR(send_message(socket, hello));
  ENGRAM_ASSIGN_OR_RETURN(auto arrived, receive_message(socket, Descriptors::kRefuse));
  if (!arrived) return unavailable("sharing: the server does not answer");
  if (arrived->message.kind != Message::Kind::kWelcome)
    return data_loss("sharing: the server did not answer the ticket");
  return refused(arrived->message, "the ticket");
}

/// Maps a received slab. Fails if its size differs from the message or could shrink, which would
/// make reads beyond its end crash.
Result<std::shared_ptr<Mapping>> map_slab(const Arrived& arrived) {
  const int fd = arrived.descriptor.get();
  if (fd < 0)
    return resource_exhausted("sharing: no descriptor left for slab {}", arrived.message.slab);
  struct stat found {};
  const int seals = ::fcntl(fd, F_GET_SEALS);
  const bool is_fixed = seals >= 0 && (seals & F_SEAL_SHRINK) != 0;
  if (::fstat(fd, &found) != 0 || !is_fixed || arrived.message.bytes == 0 ||
      static_cast<uint64_t>(found.st_size) != arrived.message.bytes)
    return data_loss("sharing: slab {} has {} bytes, its message says {}", arrived.message.slab,
                     found.st_size, arrived.message.bytes);
  return Mapping::make(fd, arrived.message.bytes, arrived.message.is_writer != 0);
}

Status check_within(const BlockRef& block, size_t slab_bytes) {
  if (block.capacity <= slab_bytes && block.offset <= slab_bytes - block.capacity) return {};
  return invalid_argument("block of slab {}: found {}+{}, needs to lie in {} bytes", block.slab,
                          block.offset, block.capacity, slab_bytes);
}

}  // namespace

struct SharingClient::State {
  State(Descriptor connected, const Options& given)
      : options(given), socket(std::move(connected)), released(std::make_shared<Released>()) {}

  const Options options;
  Descriptor socket;
  std::atomic<bool> is_connected{true};

  mutable SharedMutex mapping_mutex;
  std::unordered_map<SlabId, std::shared_ptr<Mapping>> mappings ENGRAM_GUARDED_BY(mapping_mutex);

  /// A slab that one or several threads have requested.
  struct Opening {
    std::optional<Status> outcome;
  };
  Mutex opening_mutex ENGRAM_ACQUIRED_BEFORE(mapping_mutex);
  ConditionVariable opened;
  std::unordered_map<SlabId, std::shared_ptr<Opening>> openings ENGRAM_GUARDED_BY(opening_mutex);
  /// Slabs mapped for writing that the server has not sealed yet. Used by `thread` only.
  std::unordered_map<SlabId, std::shared_ptr<Mapping>> unsealed;

  std::shared_ptr<Released> released;
  std::jthread thread;

  [[nodiscard]] std::shared_ptr<Mapping> find(SlabId slab) const {
    const SharedLock lock(mapping_mutex);
    const auto found = mappings.find(slab);
    return found == mappings.end() ? nullptr : found->second;
  }

  void keep(SlabId slab, std::shared_ptr<Mapping> mapping) {
    const ExclusiveLock lock(mapping_mutex);
    mappings.emplace(slab, std::move(mapping));
  }

  void forget(SlabId slab) {
    // Declared before the lock, so that unmapping happens without it.
    std::shared_ptr<Mapping> last;
    const ExclusiveLock lock(mapping_mutex);
    const auto found = mappings.find(slab);
    if (found == mappings.end()) return;
    last = std::move(found->second);
    mappings.erase(found);
  }

  /// Wakes all threads that wait for the slab.
  void finish(SlabId slab, Status outcome) ENGRAM_EXCLUDES(opening_mutex) {
    const MutexLock lock(opening_mutex);
    const auto found = openings.find(slab);
    if (found == openings.end()) return;  // The waiting thread has timed out.
    found->second->outcome = std::move(outcome);
    openings.erase(found);
    opened.notify_all();
  }

  void end() {
    is_connected = false;
    const MutexLock lock(opening_mutex);
    for (auto& [slab, opening] : openings) opening->outcome = gone();
    openings.clear();
    opened.notify_all();
  }

  void listen();
  Status handle(const Arrived& arrived);
  Status ask(SlabId slab) ENGRAM_EXCLUDES(opening_mutex);
  Result<std::shared_ptr<Mapping>> mapping_of(const BlockRef& block);
};

void SharingClient::State::listen() {
  while (true) {
    auto arrived = receive_message(socket.get(), Descriptors::kAccept);
    if (!arrived.ok() || (*arrived && !handle(**arrived).ok())) break;
  }
  ::shutdown(socket.get(), SHUT_RDWR);
  end();
}

Status SharingClient::State::handle(const Arrived& arrived) {
  const Message& message = arrived.message;
  switch (message.kind) {
    case Message::Kind::kSlab: {
      if (Status status = refused(message, fmt::format("slab {}", message.slab)); !status.ok()) {
        finish(message.slab, std::move(status));
        return {};
      }
      auto mapping = map_slab(arrived);
      if (!mapping.ok()) {
        finish(message.slab, mapping.status());
        return {};
      }
      if (!(*mapping)->is_writable()) {
        keep(message.slab, *mapping);
        finish(message.slab, {});
        return {};
      }
      unsealed[message.slab] = *mapping;
      Message mapped;
      mapped.kind = Message::Kind::kSlabMapped;
      mapped.slab = message.slab;
      return send_message(socket.get(), mapped);
    }
    case Message::Kind::kSlabSealed: {
      const auto found = unsealed.extract(message.slab);
      Status status = refused(message, fmt::format("to seal slab {}", message.slab));
      if (status.ok() && found) keep(message.slab, found.mapped());
      finish(message.slab, std::move(status));
      return {};
    }
    case Message::Kind::kSlabGone:
      forget(message.slab);
      return {};
    default:
      break;
  }
  return data_loss("sharing: found a message of kind {}, needs one of a server",
                   static_cast<uint32_t>(message.kind));
}

Status SharingClient::State::ask(SlabId slab) {
  const MutexLock lock(opening_mutex);
  if (find(slab) != nullptr) return {};  // It was mapped for another thread meanwhile.
  auto& entry = openings[slab];
  if (entry == nullptr) {
    entry = std::make_shared<Opening>();
    Message message;
    message.kind = Message::Kind::kOpenSlab;
    message.slab = slab;
    if (Status status = send_message(socket.get(), message); !status.ok()) {
      openings.erase(slab);
      return gone();
    }
  }
  const std::shared_ptr<Opening> opening = entry;
  const auto is_done = [&]() ENGRAM_REQUIRES(opening_mutex) {
    return opening->outcome || !is_connected;
  };
  if (!opened.wait_for(opening_mutex, options.timeout, is_done)) {
    std::erase_if(openings, [&](const auto& one) { return one.second == opening; });
    return unavailable("sharing: the server does not answer for slab {}", slab);
  }
  return opening->outcome ? *opening->outcome : gone();
}

Result<std::shared_ptr<Mapping>> SharingClient::State::mapping_of(const BlockRef& block) {
  if (!is_connected) return gone();
  auto mapping = find(block.slab);
  if (mapping == nullptr) {
    ENGRAM_RETURN_IF_ERROR(ask(block.slab));
    mapping = find(block.slab);
    if (mapping == nullptr) return not_found("sharing: slab {} was given back", block.slab);
  }
  ENGRAM_RETURN_IF_ERROR(check_within(block, mapping->size()));
  return mapping;
}

Status SharingClient::Options::validate() const {
  if (timeout < std::chrono::milliseconds(1) || timeout > std::chrono::hours(1))
    return invalid_argument("timeout: found {}, needs 1ms to 1h", to_string(timeout));
  return {};
}

SharingClient::SharingClient(std::unique_ptr<State> state) : state_(std::move(state)) {}

SharingClient::~SharingClient() {
  ::shutdown(state_->socket.get(), SHUT_RDWR);
  if (state_->thread.joinable()) state_->thread.join();
}

Result<std::unique_ptr<SharingClient>> SharingClient::connect(const std::filesystem::path& socket,
                                                              const Ticket& ticket,
                                                              const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  const auto timeout = std::chrono::duration_cast<std::chrono::milliseconds>(options.timeout);
  ENGRAM_ASSIGN_OR_RETURN(Descriptor connected,
                          connect_socket(socket, static_cast<int>(timeout.count())));
  ENGRAM_RETURN_IF_ERROR(check_server(connected.get(), options));
  ENGRAM_RETURN_IF_ERROR(greet(connected.get(), ticket));
  const timeval for_ever{};
  ::setsockopt(connected.get(), SOL_SOCKET, SO_RCVTIMEO, &for_ever, sizeof(for_ever));
  auto state = std::make_unique<State>(std::move(connected), options);
  state->thread = std::jthread([&listening = *state] { listening.listen(); });
  return std::unique_ptr<SharingClient>(new SharingClient(std::move(state)));
}

Result<std::span<std::byte>> SharingClient::writable(const BlockRef& block) {
  ENGRAM_ASSIGN_OR_RETURN(const KeptBlock kept, keep_writable(block));
  return kept.bytes;
}

Result<SharingClient::KeptBlock> SharingClient::keep_writable(const BlockRef& block) {
  ENGRAM_ASSIGN_OR_RETURN(const auto mapping, state_->mapping_of(block));
  if (!mapping->is_writable())
    return invalid_argument("block of slab {}: is another's, needs one that was leased to us",
                            block.slab);
  return KeptBlock{mapping, mapping->writable().subspan(block.offset, block.capacity)};
}

Result<Buffer> SharingClient::readable(const BlockRef& block, size_t bytes, OnRelease on_release) {
  ENGRAM_ASSIGN_OR_RETURN(auto mapping, state_->mapping_of(block));
  if (bytes > block.capacity)
    return invalid_argument("block of slab {}: found {} bytes, needs at most {}", block.slab, bytes,
                            block.capacity);
  const std::span<const std::byte> view(mapping->data() + block.offset, bytes);
  return Buffer(std::make_shared<const Reading>(std::move(mapping), block, state_->released,
                                                std::move(on_release)),
                view);
}

std::vector<BlockRef> SharingClient::take_released() {
  const MutexLock lock(state_->released->mutex);
  return std::exchange(state_->released->blocks, {});
}

bool SharingClient::is_connected() const {
  return state_->is_connected;
}

}  // namespace engram::server
