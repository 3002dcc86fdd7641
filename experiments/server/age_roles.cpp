// SPDX-License-Identifier: Apache-2.0
#include "server/age_roles.h"

#include <engram/v1/memory.grpc.pb.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>

#include <deque>
#include <mutex>

#include "ltm/core/log.h"
#include "server/client/client_stream.h"
#include "server/client/memory_client.h"
#include "server/robot/memory_server.h"
#include "server/wire/byte_message.h"
#include "server/wire/polling_threads.h"
#include "server/wire/wire_snapshot.h"

namespace engram::experiments {

namespace {

using Bytes = grpc::ByteBuffer;
// The services take raw bytes, so that a relay does not parse messages.
using RawService = v1::MemoryServer::WithRawCallbackMethod_Commit<
    v1::MemoryServer::WithRawCallbackMethod_Subscribe<v1::MemoryServer::Service>>;

/// Reads a stream of commits.
class Intake final : public grpc::ServerBidiReactor<Bytes, Bytes> {
 public:
  explicit Intake(std::function<void(Bytes&)> on_bytes) : on_bytes_(std::move(on_bytes)) {
    StartRead(&bytes_);
  }
  void OnReadDone(bool ok) override {
    if (!ok) {
      Finish(grpc::Status::OK);
      return;
    }
    on_bytes_(bytes_);
    bytes_.Clear();
    StartRead(&bytes_);
  }
  void OnDone() override { delete this; }

 private:
  std::function<void(Bytes&)> on_bytes_;
  Bytes bytes_;
};

/// Forwards bytes unchanged.
class Outlet final : public grpc::ServerBidiReactor<Bytes, Bytes> {
 public:
  Outlet() { StartRead(&bytes_); }
  void send(const Bytes& bytes) {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back(bytes);
    if (waiting_.size() == 1) StartWrite(&waiting_.front());
  }
  void OnWriteDone(bool /*ok*/) override {
    const std::scoped_lock lock(mutex_);
    waiting_.pop_front();
    if (!waiting_.empty()) StartWrite(&waiting_.front());
  }
  void OnCancel() override { Finish(grpc::Status::CANCELLED); }
  void OnDone() override {}

 private:
  Bytes bytes_;
  std::mutex mutex_;
  std::deque<Bytes> waiting_;
};

class RelayService final : public RawService {
 public:
  grpc::ServerBidiReactor<Bytes, Bytes>* Commit(grpc::CallbackServerContext* /*call*/) override {
    return new Intake([this](Bytes& bytes) {
      const std::scoped_lock lock(mutex_);
      for (const auto& outlet : outlets_) outlet->send(bytes);
    });
  }
  grpc::ServerBidiReactor<Bytes, Bytes>* Subscribe(grpc::CallbackServerContext* /*call*/) override {
    const std::scoped_lock lock(mutex_);
    outlets_.push_back(std::make_unique<Outlet>());
    return outlets_.back().get();
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Outlet>> outlets_;
};

Result<ltm::Commit> read_commit(Bytes& bytes) {
  v1::CommitRequest request;
  ENGRAM_RETURN_IF_ERROR(server::read_message(bytes, request));
  ENGRAM_ASSIGN_OR_RETURN(auto commit, server::take_commit(request, {}));
  return std::move(commit.commit);
}

void measure(Bytes& bytes, const std::function<void(int64_t)>& on_age) {
  const auto commit = read_commit(bytes);
  if (commit.ok()) on_age(steady_ns() - made_ns(*commit));
}

class DirectService final : public RawService {
 public:
  explicit DirectService(std::function<void(int64_t)> on_age) : on_age_(std::move(on_age)) {}
  grpc::ServerBidiReactor<Bytes, Bytes>* Commit(grpc::CallbackServerContext* /*call*/) override {
    return new Intake([this](Bytes& bytes) { measure(bytes, on_age_); });
  }

 private:
  std::function<void(int64_t)> on_age_;
};

class ServiceRole final : public AgeRole {
 public:
  static Result<std::unique_ptr<AgeRole>> start(const std::string& endpoint,
                                                std::unique_ptr<grpc::Service> service) {
    auto role = std::make_unique<ServiceRole>();
    role->service_ = std::move(service);
    grpc::ServerBuilder builder;
    builder.AddListeningPort(endpoint, grpc::InsecureServerCredentials());
    builder.SetMaxReceiveMessageSize(-1);
    builder.RegisterService(role->service_.get());
    role->server_ = builder.BuildAndStart();
    if (!role->server_) return unavailable("'{}' cannot be listened on", endpoint);
    return std::unique_ptr<AgeRole>(std::move(role));
  }

 private:
  std::unique_ptr<grpc::Service> service_;
  std::unique_ptr<grpc::Server> server_;
};

class MemoryRole final : public AgeRole {
 public:
  std::unique_ptr<server::MemoryServer> server;
};

class RelayConsumer final : public AgeRole {
 public:
  server::OpenStreams streams;
  std::shared_ptr<server::ClientStream> stream;
  ~RelayConsumer() override {
    stream->cancel();
    stream.reset();
    streams.wait();
  }
};

/// Reports the age of a commit when the last snapshot of its batch has arrived.
class MemoryConsumer final : public AgeRole {
 public:
  MemoryConsumer(int batch, std::function<void(int64_t)> on_age)
      : batch_(static_cast<size_t>(batch)), on_age_(std::move(on_age)) {}

  Status begin(const std::string& endpoint, bool with_query) {
    ENGRAM_ASSIGN_OR_RETURN(client_, server::MemoryClient::connect(endpoint));
    SubscriptionHandlers handlers;
    handlers.on_snapshots = [this](std::vector<ToldSnapshot> told) { take(told); };
    ENGRAM_ASSIGN_OR_RETURN(
        subscription_,
        client_->subscribe({.names = {"Bench"}, .with_data = !with_query, .queue_bound = 100'000},
                           std::move(handlers)));
    return {};
  }

 private:
  void take(const std::vector<ToldSnapshot>& told) {
    for (const ToldSnapshot& one : told) {
      if (one.has_data) {
        if (++come_ % batch_ == 0)
          on_age_(steady_ns() - made_ns(one.snapshot.instances.front().data));
        continue;
      }
      asked_.push_back(one.snapshot.id());
      if (asked_.size() == batch_) ask();
    }
  }

  /// Requests a whole batch in one query.
  void ask() {
    std::vector<ltm::MemoryId> ids;
    ids.swap(asked_);
    std::string text;
    for (const ltm::MemoryId& id : ids)
      text += fmt::format("{}{} @ {}", text.empty() ? "" : " ; ", id.entity().to_string(),
                          to_ns(*id.time()));
    const auto query = ltm::Query::parse(text);
    if (!query.ok()) return;
    client_->query(*query, "", [this, count = ids.size()](Result<ltm::QueryResult> answer) {
      if (!answer.ok() || answer->snapshot_count() != count) return;
      const ltm::EntityResult& last = *answer->entities().back();
      on_age_(steady_ns() - made_ns(last.snapshots.back().instances.front().data));
    });
  }

  const size_t batch_;
  const std::function<void(int64_t)> on_age_;
  size_t come_ = 0;
  std::vector<ltm::MemoryId> asked_;  ///< Not locked, because handlers run one at a time.
  std::unique_ptr<server::MemoryClient> client_;
  std::unique_ptr<Subscription> subscription_;
};

class StreamProducer final : public AgeProducer {
 public:
  explicit StreamProducer(const std::shared_ptr<grpc::Channel>& channel)
      : channel_(channel),
        stream_(server::ClientStream::open(
            channel, "/engram.v1.MemoryServer/Commit", "", streams_,
            {[](Bytes& /*bytes*/) {}, [](const Status& /*status*/) {}})) {}
  ~StreamProducer() override {
    stream_->cancel();
    stream_.reset();
    streams_.wait();
  }

  Status send(const ltm::Commit& commit) override {
    v1::CommitRequest request;
    for (const ltm::EntityUpdate& update : commit.updates) {
      ENGRAM_ASSIGN_OR_RETURN(*request.add_updates(), server::to_message(update));
    }
    return stream_->send(server::to_bytes(request));
  }
  Result<int64_t> acknowledged(const ltm::Commit& /*commit*/) override {
    return failed_precondition("a stream acknowledges nothing");
  }

 private:
  std::shared_ptr<grpc::Channel> channel_;
  server::OpenStreams streams_;
  std::shared_ptr<server::ClientStream> stream_;
};

class MemoryProducer final : public AgeProducer {
 public:
  explicit MemoryProducer(std::unique_ptr<server::MemoryClient> client)
      : client_(std::move(client)) {}
  Status send(const ltm::Commit& commit) override {
    client_->commit(commit, CommitDurability::kDefault, [](const Status& status) {
      if (!status.ok()) log::warning("commit: {}", status.to_string());
    });
    return {};
  }
  Result<int64_t> acknowledged(const ltm::Commit& commit) override {
    const int64_t began = steady_ns();
    ENGRAM_RETURN_IF_ERROR(client_->commit(commit));
    return steady_ns() - began;
  }

 private:
  std::unique_ptr<server::MemoryClient> client_;
};

std::shared_ptr<grpc::Channel> channel_to(const std::string& endpoint) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return grpc::CreateCustomChannel(endpoint, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

const char* to_string(AgeWay way) {
  switch (way) {
    case AgeWay::kDirect:
      return "direct";
    case AgeWay::kRelay:
      return "relay";
    case AgeWay::kMemory:
      return "memory, data told";
    case AgeWay::kMemoryQuery:
      return "memory, IDs told, query";
  }
  return "";
}

void tune_plain_grpc() {
  server::PollingThreads::of_process();
}

Result<std::unique_ptr<AgeRole>> start_memory(const std::string& endpoint, int entries) {
  server::MemoryServer::Options options;
  options.service.name = "age";
  options.service.memory.mode = ltm::StoreMode::kLatest;
  options.service.memory.all.snapshots = static_cast<size_t>(entries);
  ENGRAM_ASSIGN_OR_RETURN(const auto place, server::Endpoint::parse(endpoint));
  options.rpc.endpoints = {place};
  auto role = std::make_unique<MemoryRole>();
  ENGRAM_ASSIGN_OR_RETURN(role->server, server::MemoryServer::start(options, nullptr));
  for (int i = 0; i < entries; ++i) {
    ltm::Commit commit = make_commit(AgeObject::kModerate, 1, time_from_ns(i + 1), 1);
    commit.updates[0].entity = *ltm::MemoryId::parse(fmt::format("Held/Object/before/{}", i % 100));
    ENGRAM_RETURN_IF_ERROR(role->server->commit(std::move(commit)));
  }
  return std::unique_ptr<AgeRole>(std::move(role));
}

Result<std::unique_ptr<AgeRole>> start_relay(const std::string& endpoint) {
  return ServiceRole::start(endpoint, std::make_unique<RelayService>());
}

Result<std::unique_ptr<AgeRole>> start_consumer(AgeWay way, const std::string& endpoint, int batch,
                                                std::function<void(int64_t)> on_age) {
  if (way == AgeWay::kDirect)
    return ServiceRole::start(endpoint, std::make_unique<DirectService>(std::move(on_age)));
  if (way == AgeWay::kRelay) {
    const auto channel = channel_to(endpoint);
    auto consumer = std::make_unique<RelayConsumer>();
    consumer->stream = server::ClientStream::open(
        channel, "/engram.v1.MemoryServer/Subscribe", "", consumer->streams,
        {[on_age = std::move(on_age)](Bytes& bytes) { measure(bytes, on_age); },
         [](const Status& /*status*/) {}});
    return std::unique_ptr<AgeRole>(std::move(consumer));
  }
  auto consumer = std::make_unique<MemoryConsumer>(batch, std::move(on_age));
  ENGRAM_RETURN_IF_ERROR(consumer->begin(endpoint, way == AgeWay::kMemoryQuery));
  return std::unique_ptr<AgeRole>(std::move(consumer));
}

Result<std::unique_ptr<AgeProducer>> start_producer(AgeWay way, const std::string& endpoint) {
  if (way == AgeWay::kMemory || way == AgeWay::kMemoryQuery) {
    ENGRAM_ASSIGN_OR_RETURN(auto client, server::MemoryClient::connect(endpoint));
    return std::unique_ptr<AgeProducer>(std::make_unique<MemoryProducer>(std::move(client)));
  }
  return std::unique_ptr<AgeProducer>(std::make_unique<StreamProducer>(channel_to(endpoint)));
}

}  // namespace engram::experiments
