// SPDX-License-Identifier: Apache-2.0
#include "server/wire/polling_threads.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>

#include <algorithm>
#include <thread>

#include "ltm/core/mutex.h"
#include "ltm/core/time.h"

namespace engram::server {

namespace {

/// How often the working thread is checked.
constexpr auto kTick = std::chrono::milliseconds(100);
/// The thread keeps up if it answers an empty call within this time.
constexpr auto kKeepsUp = std::chrono::milliseconds(5);
/// How long all threads work after it did not keep up.
constexpr auto kAllFor = std::chrono::seconds(1);
/// With this many cores gRPC has more than two threads, and the machine profits from all of them.
constexpr unsigned kManyCores = 8;

thread_local bool is_polling_thread = false;

/// Calls that fail at once, without a connection. Their only effect is a callback in a polling
/// thread.
class CallsOfNothing {
 public:
  /// Calls `back` in a polling thread.
  void call(std::function<void()> back) {
    struct Call {
      grpc::ClientContext context;
      grpc::Slice nothing;
      grpc::ByteBuffer request{&nothing, 1};
      grpc::ByteBuffer reply;
    };
    auto call = std::make_shared<Call>();
    stub_.UnaryCall(&call->context, "/engram/Nothing", {}, &call->request, &call->reply,
                    [call, back = std::move(back)](const grpc::Status& /*status*/) {
                      is_polling_thread = true;
                      back();
                    });
  }

 private:
  grpc::GenericStub stub_{grpc::CreateCustomChannel("nowhere", nullptr, grpc::ChannelArguments())};
};

}  // namespace

/// The object is never destroyed: gRPC joins its threads with the last channel, and one of them
/// could be held back then.
void PollingThreads::call(std::function<void()> back) {
  static CallsOfNothing* const calls = new CallsOfNothing;
  calls->call(std::move(back));
}

struct PollingThreads::State : std::enable_shared_from_this<State> {
  mutable Mutex mutex;
  ConditionVariable changed;                       ///< Wakes the keeper.
  ConditionVariable released;                      ///< Wakes held threads.
  int held ENGRAM_GUARDED_BY(mutex) = 0;           ///< Threads held back here.
  int blocked ENGRAM_GUARDED_BY(mutex) = 0;        ///< Threads that wait in handlers.
  bool is_asked ENGRAM_GUARDED_BY(mutex) = false;  ///< A call to hold a thread is on its way.
  bool is_holding ENGRAM_GUARDED_BY(mutex) = false;
  bool is_ending ENGRAM_GUARDED_BY(mutex) = false;
  SteadyTime all_until ENGRAM_GUARDED_BY(mutex){};
  /// Number of the last call that checks whether the thread keeps up.
  uint64_t asked_at_last ENGRAM_GUARDED_BY(mutex) = 0;
  uint64_t answered ENGRAM_GUARDED_BY(mutex) = 0;
  std::thread keeper;

  /// Holds the polling thread that runs it.
  void be_held() {
    const MutexLock lock(mutex);
    is_asked = false;
    ++held;
    released.wait(mutex, [this]() ENGRAM_REQUIRES(mutex) { return !is_holding || is_ending; });
    --held;
  }

  void let_all_work() ENGRAM_REQUIRES(mutex) {
    is_holding = false;
    all_until = steady_now() + kAllFor;
    released.notify_all();
  }

  void hold_one() ENGRAM_REQUIRES(mutex) {
    is_holding = true;
    is_asked = true;
    mutex.unlock();
    call([self = shared_from_this()] { self->be_held(); });
    mutex.lock();
  }

  /// Whether the working thread answers within `time`.
  bool keeps_up(Duration time) ENGRAM_REQUIRES(mutex) {
    const uint64_t number = ++asked_at_last;
    mutex.unlock();
    call([self = shared_from_this(), number] {
      const MutexLock answering(self->mutex);
      self->answered = std::max(self->answered, number);
      self->changed.notify_all();
    });
    mutex.lock();
    return changed.wait_for(
        mutex, time, [&]() ENGRAM_REQUIRES(mutex) { return answered >= number || is_ending; });
  }

  void keep() {
    const MutexLock lock(mutex);
    while (!is_ending) {
      if (is_holding && !is_asked && !keeps_up(kKeepsUp)) let_all_work();
      const bool all_work = !is_holding && !is_asked && held == 0 && blocked == 0;
      if (all_work && steady_now() >= all_until) hold_one();
      changed.wait_for(mutex, kTick, [this]() ENGRAM_REQUIRES(mutex) { return is_ending; });
    }
  }

  void end() {
    {
      const MutexLock lock(mutex);
      is_ending = true;
    }
    changed.notify_all();
    released.notify_all();
    if (keeper.joinable()) keeper.join();
  }
};

PollingThreads& PollingThreads::of_process() {
  // Not destroyed, because blocking handlers may use it while the process ends; only the keeper
  // thread is stopped.
  static PollingThreads* const threads = new PollingThreads;
  struct KeeperEnd {
    ~KeeperEnd() { threads->state_->end(); }
  };
  static const KeeperEnd at_end;
  return *threads;
}

PollingThreads::PollingThreads() : state_(std::make_shared<State>()) {
  if (std::thread::hardware_concurrency() >= kManyCores) return;
  State& state = *state_;
  state.keeper = std::thread([&state] { state.keep(); });
}

int PollingThreads::blocked() const {
  const MutexLock lock(state_->mutex);
  return state_->blocked;
}

int PollingThreads::held() const {
  const MutexLock lock(state_->mutex);
  return state_->held;
}

BlockingScope::BlockingScope() : is_polling_thread_(is_polling_thread) {
  if (!is_polling_thread_) return;
  auto& state = *PollingThreads::of_process().state_;
  const MutexLock lock(state.mutex);
  ++state.blocked;
  state.let_all_work();
}

BlockingScope::~BlockingScope() {
  if (!is_polling_thread_) return;
  auto& state = *PollingThreads::of_process().state_;
  const MutexLock lock(state.mutex);
  --state.blocked;
}

}  // namespace engram::server
