// SPDX-License-Identifier: Apache-2.0
// What sharing memory costs: the books of a block, and a batch of 100 images of 49 kB that one
// process writes and another reads, beside copying it and sending it through a socket.
#include <benchmark/benchmark.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <numeric>
#include <vector>

#include "server/sharing/sharing_client.h"
#include "server/sharing/sharing_server.h"

namespace engram::server {
namespace {

constexpr ClientId kClient = 1;
constexpr GroupId kGroup = 1;
constexpr size_t kBatchBytes = 100 * 49'000;

std::unique_ptr<SharedPool> make_pool() {
  return std::move(*SharedPool::create({}));
}

/// Argument: bytes of a block.
void LeaseCommitViewRelease(benchmark::State& state) {
  static const auto pool = make_pool();
  const auto bytes = static_cast<size_t>(state.range(0));
  for (auto _ : state) {
    const BlockRef block = *pool->lease(kServerItself, kGroup, bytes);
    const Buffer first = *pool->commit(kServerItself, kGroup, block, bytes);
    const Buffer second = *pool->view(block, bytes);
    benchmark::DoNotOptimize(second.data());
  }
}
BENCHMARK(LeaseCommitViewRelease)->Arg(64)->Arg(4 << 20)->Threads(1)->Threads(2)->UseRealTime();

/// The same with so many other blocks there, of which every second is free.
void LeaseCommitAmongMany(benchmark::State& state) {
  const auto pool = make_pool();
  std::vector<Buffer> kept;
  for (int64_t i = 0; i < state.range(0); ++i) {
    const BlockRef block = *pool->lease(kServerItself, kGroup, 8192);
    Buffer buffer = *pool->commit(kServerItself, kGroup, block, 8192);
    const BlockRef other = *pool->lease(kServerItself, kGroup, 8192);
    if (!pool->abandon(kServerItself, other).ok()) std::abort();
    kept.push_back(std::move(buffer));
  }
  for (size_t i = 0; i < kept.size(); i += 2) kept[i] = Buffer();
  for (auto _ : state) {
    const BlockRef block = *pool->lease(kServerItself, kGroup, 4096);
    benchmark::DoNotOptimize(pool->commit(kServerItself, kGroup, block, 4096));
  }
}
BENCHMARK(LeaseCommitAmongMany)->Arg(20'000);

void ShareRelease(benchmark::State& state) {
  const auto pool = make_pool();
  if (!pool->add_client(kClient).ok() || !pool->grant_read(kClient, kGroup).ok()) std::abort();
  const BlockRef block = *pool->lease(kServerItself, kGroup, 4096);
  const Buffer kept = *pool->commit(kServerItself, kGroup, block, 4096);
  for (auto _ : state) {
    benchmark::DoNotOptimize(pool->locate(kept.bytes()));
    if (!pool->share(block, kClient).ok() || !pool->release(kClient, block).ok()) std::abort();
  }
}
BENCHMARK(ShareRelease);

void CopyBatch(benchmark::State& state) {
  const std::vector<std::byte> from(kBatchBytes, std::byte{1});
  std::vector<std::byte> to(kBatchBytes);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), kBatchBytes);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(CopyBatch)->UseRealTime();

uint64_t sum(std::span<const std::byte> bytes) {
  uint64_t total = 0;
  for (size_t at = 0; at + sizeof(total) <= bytes.size(); at += sizeof(total)) {
    uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof(word));
    total += word;
  }
  return total;
}

/// A child that does one thing for each request that comes through a socket.
template <typename Request>
class Child {
 public:
  template <typename Prepare>
  explicit Child(Prepare prepare) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) std::abort();
    pid_ = ::fork();
    if (pid_ == 0) {
      ::close(ends[0]);
      auto serve = prepare(ends[1]);
      for (Request request; ::read(ends[1], &request, sizeof(request)) == sizeof(request);) {
        serve(request);
        const char done = 1;
        if (::write(ends[1], &done, 1) != 1) break;
      }
      ::_exit(0);
    }
    ::close(ends[1]);
    socket_ = Descriptor(ends[0]);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }

  void ask(const Request& request) const {
    if (::write(socket_.get(), &request, sizeof(request)) != sizeof(request)) std::abort();
  }
  void wait() const {
    char done = 0;
    if (::read(socket_.get(), &done, 1) != 1) std::abort();
  }
  [[nodiscard]] int socket() const { return socket_.get(); }

 private:
  pid_t pid_ = 0;
  Descriptor socket_;
};

/// A child that does nothing: what the others wait for in any case.
void AskChild(benchmark::State& state) {
  const Child<char> child([](int) { return [](char) {}; });
  for (auto _ : state) {
    child.ask(0);
    child.wait();
  }
}
BENCHMARK(AskChild)->UseRealTime();

/// Argument: whether all of it is read, too.
void ShareBatch(benchmark::State& state) {
  std::string name = (std::filesystem::temp_directory_path() / "sharing-XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  const auto pool = make_pool();
  // Before there are threads.
  const Child<BlockRef> child([&folder](int requests) {
    Ticket ticket;
    if (::read(requests, ticket.data(), ticket.size()) != sizeof(ticket)) std::abort();
    std::shared_ptr client = std::move(*SharingClient::connect(folder / "socket", ticket, {}));
    if (::write(requests, "", 1) != 1) std::abort();
    return [client, batch = std::vector<std::byte>(kBatchBytes, std::byte{1})](BlockRef block) {
      std::memcpy(client->writable(block)->data(), batch.data(), batch.size());
    };
  });
  SharingServer::Options options;
  options.socket = folder / "socket";
  const auto server = std::move(*SharingServer::start(*pool, options));
  const Ticket ticket = *server->issue_ticket(kClient);
  if (::write(child.socket(), ticket.data(), ticket.size()) != sizeof(ticket)) std::abort();
  child.wait();
  for (auto _ : state) {
    const BlockRef block = *pool->lease(kClient, kGroup, kBatchBytes);
    child.ask(block);
    child.wait();
    const Buffer batch = *pool->commit(kClient, kGroup, block, kBatchBytes);
    benchmark::DoNotOptimize(state.range(0) != 0 ? sum(batch.bytes()) : batch.size());
  }
  std::filesystem::remove_all(folder);
}
BENCHMARK(ShareBatch)->Arg(0)->Arg(1)->UseRealTime();

/// Argument: whether all of it is read, too.
void SendBatch(benchmark::State& state) {
  const Child<char> child([](int socket) {
    return [socket, batch = std::vector<std::byte>(kBatchBytes, std::byte{1})](char) {
      for (size_t sent = 0; sent < batch.size();) {
        const ssize_t count = ::write(socket, batch.data() + sent, batch.size() - sent);
        if (count <= 0) ::_exit(1);
        sent += static_cast<size_t>(count);
      }
    };
  });
  std::vector<std::byte> batch(kBatchBytes);
  for (auto _ : state) {
    child.ask(0);
    for (size_t got = 0; got < batch.size();) {
      const ssize_t count = ::read(child.socket(), batch.data() + got, batch.size() - got);
      if (count <= 0) std::abort();
      got += static_cast<size_t>(count);
    }
    child.wait();
    benchmark::DoNotOptimize(state.range(0) != 0 ? sum(batch) : batch.size());
  }
}
BENCHMARK(SendBatch)->Arg(0)->Arg(1)->UseRealTime();

}  // namespace
}  // namespace engram::server
