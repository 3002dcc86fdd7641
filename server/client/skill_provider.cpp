// SPDX-License-Identifier: Apache-2.0
#include "server/client/skill_provider.h"

#include <engram/v1/memory.pb.h>

#include <list>
#include <map>
#include <thread>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/idf/json.h"
#include "ltm/skills/skill_ids.h"
#include "server/access/default_endpoint.h"
#include "server/client/client_stream.h"
#include "server/client/names_client.h"
#include "server/client/open_channel.h"
#include "server/skills/skill_description.h"
#include "server/wire/byte_message.h"
#include "server/wire/wire_status.h"

namespace engram {

namespace {

using server::ClientStream;
using server::to_bytes;

constexpr auto kConnectAgainAfter = std::chrono::milliseconds(100);

/// The stream of one connection. Executions keep the one that started them.
using SharedStream = std::shared_ptr<ClientStream>;

class RemoteRun final : public SkillRun {
 public:
  RemoteRun(const v1::ProvideReply::Start& start, SharedStream stream, idf::Data parameters,
            ltm::MemoryId execution, ltm::MemoryId request)
      : name_(start.execution()),
        stream_(std::move(stream)),
        parameters_(std::move(parameters)),
        execution_(std::move(execution)),
        request_(std::move(request)) {}

  [[nodiscard]] const idf::Data& parameters() const override { return parameters_; }
  [[nodiscard]] std::stop_token stop() const override { return stop_.get_token(); }
  [[nodiscard]] std::string stop_reason() const override {
    const MutexLock lock(mutex_);
    return reason_;
  }
  [[nodiscard]] const ltm::MemoryId& execution() const override { return execution_; }
  [[nodiscard]] const ltm::MemoryId& request() const override { return request_; }

  Status report(const idf::Data& data, const std::vector<ltm::MemoryId>& links) override {
    return send(v1::SkillReport::NONE, "", data, links);
  }

  void stop_for(const std::string& reason) {
    {
      const MutexLock lock(mutex_);
      reason_ = reason;
    }
    stop_.request_stop();
  }

  Status end(const SkillEnd& end) {
    const auto said = end.outcome == SkillOutcome::kSuccess ? v1::SkillReport::SUCCESS
                      : end.outcome == SkillOutcome::kStop  ? v1::SkillReport::STOP
                                                            : v1::SkillReport::FAILURE;
    return send(said, end.reason, end.result, end.links);
  }

 private:
  Status send(v1::SkillReport::End end, const std::string& reason, const idf::Data& data,
              const std::vector<ltm::MemoryId>& links) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string json, idf::to_json_text(data));
    v1::ProvideRequest message;
    v1::SkillReport& report = *message.mutable_report();
    report.set_execution(name_);
    report.set_data_json(json);
    for (const ltm::MemoryId& link : links) report.add_links(link.to_string());
    report.set_end(end);
    report.set_reason(reason);
    return stream_->send(to_bytes(message));
  }

  const std::string name_;
  const SharedStream stream_;
  const idf::Data parameters_;
  const ltm::MemoryId execution_;
  const ltm::MemoryId request_;
  std::stop_source stop_;
  mutable Mutex mutex_;
  std::string reason_ ENGRAM_GUARDED_BY(mutex_);
};

/// A description names its skill; a name alone is that of one that is known before.
Result<std::string> skill_in(std::string_view description) {
  if (description.find(':') == std::string_view::npos) return std::string(description);
  ENGRAM_ASSIGN_OR_RETURN(const auto parsed, skills::SkillDescription::parse(description));
  return parsed.name;
}

class RemoteProvider final : public SkillProvider {
 public:
  RemoteProvider(std::string endpoint, std::string name, ConnectOptions options)
      : endpoint_(std::move(endpoint)), name_(std::move(name)), options_(std::move(options)) {}

  ~RemoteProvider() override {
    {
      const MutexLock lock(mutex_);
      is_ending_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
    stop_all("its provider ends");
    join_runs(true);
    SharedStream stream;
    {
      const MutexLock lock(mutex_);
      stream = std::move(stream_);
    }
    if (stream) stream->cancel();
    stream.reset();
    streams_.wait();
  }

  Status begin() {
    const SteadyTime until = steady_now() + options_.timeout;
    Status status = open();
    // A provider that was killed a moment ago may still count as connected.
    while (!status.ok() && steady_now() < until &&
           (status.code() == StatusCode::kUnavailable ||
            status.code() == StatusCode::kAlreadyExists)) {
      std::this_thread::sleep_for(kConnectAgainAfter);
      status = open();
    }
    ENGRAM_RETURN_IF_ERROR(status);
    thread_ = std::thread([this] { keep_connected(); });
    return {};
  }

  Status add(std::string_view description, SkillFunction function) override {
    ENGRAM_ASSIGN_OR_RETURN(const std::string skill, skill_in(description));
    {
      const MutexLock lock(mutex_);
      if (skills_.contains(skill))
        return already_exists("provider '{}': has a skill '{}' already", name_, skill);
      skills_.emplace(skill, Skill{std::string(description), std::move(function)});
    }
    v1::ProvideRequest message;
    message.add_added(std::string(description));
    const Status status = tell(message);
    if (status.ok()) return {};
    const MutexLock lock(mutex_);
    skills_.erase(skill);
    return status;
  }

  Status remove(const std::string& skill) override {
    {
      const MutexLock lock(mutex_);
      if (skills_.erase(skill) == 0)
        return not_found("provider '{}': has no skill '{}'", name_, skill);
    }
    v1::ProvideRequest message;
    message.add_removed(skill);
    return tell(message);
  }

  [[nodiscard]] size_t running() const override {
    const MutexLock lock(mutex_);
    return runs_.size();
  }

 private:
  struct Skill {
    std::string description;
    SkillFunction function;
  };
  struct Thread {
    std::thread thread;
    bool is_over = false;
  };

  Result<std::string> endpoint() const {
    if (!options_.is_name_system) {
      if (!endpoint_.empty()) return endpoint_;
      ENGRAM_ASSIGN_OR_RETURN(const server::Endpoint usual, server::default_endpoint());
      return usual.to_string();
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto names,
                            server::NamesClient::connect(endpoint_, client_options()));
    ENGRAM_ASSIGN_OR_RETURN(const auto found, names->resolve(std::string(skills::kSkillMemory)));
    if (found.empty() || found.front().endpoints.empty())
      return unavailable("name system '{}': no server has the memory '{}' yet", endpoint_,
                         skills::kSkillMemory);
    return found.front().endpoints.front();
  }

  [[nodiscard]] server::ClientOptions client_options() const {
    server::ClientOptions client;
    client.token = options_.token;
    client.ca = options_.ca;
    client.timeout = options_.timeout;
    return client;
  }

  /// Opens a stream, says what there is, and waits for the answer.
  Status open() ENGRAM_EXCLUDES(mutex_) {
    const server::BlockingScope blocking;
    ENGRAM_ASSIGN_OR_RETURN(const std::string where, endpoint());
    ENGRAM_ASSIGN_OR_RETURN(const server::Endpoint parsed, server::Endpoint::parse(where));
    std::shared_ptr<grpc::Channel>& channel = channels_[where];
    if (!channel) {
      ENGRAM_ASSIGN_OR_RETURN(channel, server::open_channel(parsed, client_options()));
    }
    v1::ProvideRequest hello;
    hello.set_provider(name_);
    uint64_t generation = 0;
    {
      const MutexLock lock(mutex_);
      generation = ++generation_;
      taken_.reset();
      is_open_ = true;
      for (const auto& [skill, known] : skills_) hello.add_added(known.description);
    }
    auto stream = ClientStream::open(
        channel, "/engram.v1.MemoryServer/Provide", options_.token, streams_,
        {[this, generation](grpc::ByteBuffer& bytes) { take(generation, bytes); },
         [this, generation](const Status& status) { end(generation, status); }});
    {
      const MutexLock lock(mutex_);
      stream_ = stream;
    }
    if (const Status status = stream->send(to_bytes(hello)); !status.ok()) return status;
    return wait_taken();
  }

  Status wait_taken() ENGRAM_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    const bool is_told = changed_.wait_for(
        mutex_, options_.timeout,
        [this]() ENGRAM_REQUIRES(mutex_) { return taken_.has_value() || !is_open_; });
    if (taken_) return *taken_;
    if (is_told) return end_status_;
    return unavailable("provider '{}': no answer within {}", name_, to_string(options_.timeout));
  }

  /// Tells of a change, and waits for the answer.
  Status tell(const v1::ProvideRequest& message) ENGRAM_EXCLUDES(mutex_) {
    const MutexLock turn(telling_);
    SharedStream stream;
    {
      const MutexLock lock(mutex_);
      // What is told when it is connected again includes this.
      if (!is_open_) return {};
      taken_.reset();
      stream = stream_;
    }
    ENGRAM_RETURN_IF_ERROR(stream->send(to_bytes(message)));
    return wait_taken();
  }

  void take(uint64_t generation, grpc::ByteBuffer& bytes) {
    v1::ProvideReply reply;
    if (!server::read_message(bytes, reply).ok()) return;
    if (reply.has_start()) start(reply.start());
    if (reply.has_stop()) {
      std::shared_ptr<RemoteRun> run;
      {
        const MutexLock lock(mutex_);
        if (const auto found = runs_.find(reply.stop().execution()); found != runs_.end())
          run = found->second;
      }
      if (run) run->stop_for(reply.stop().reason());
    }
    if (!reply.has_taken()) return;
    const MutexLock lock(mutex_);
    if (generation != generation_) return;
    taken_ = server::to_status(static_cast<grpc::StatusCode>(reply.taken().code()),
                               reply.taken().message());
    changed_.notify_all();
  }

  void end(uint64_t generation, const Status& status) {
    const MutexLock lock(mutex_);
    if (generation != generation_) return;
    is_open_ = false;
    end_status_ = status;
    changed_.notify_all();
  }

  void start(const v1::ProvideReply::Start& start) {
    auto parameters = idf::from_json_text(start.parameters_json());
    auto execution = ltm::MemoryId::parse(start.execution());
    auto request = ltm::MemoryId::parse(start.request());
    if (!parameters.ok() || !execution.ok() || !request.ok()) {
      log::warning("provider '{}': what it was told to start cannot be read", name_);
      return;
    }
    join_runs(false);
    const MutexLock lock(mutex_);
    auto run = std::make_shared<RemoteRun>(start, stream_, *std::move(parameters),
                                           *std::move(execution), *std::move(request));
    const auto skill = skills_.find(start.skill());
    if (skill == skills_.end() || is_ending_) {
      const Status said = run->end(SkillEnd::failure(
          fmt::format("provider '{}' has no skill '{}' any more", name_, start.skill())));
      if (!said.ok()) log::debug("provider '{}': {}", name_, said.message());
      return;
    }
    runs_.emplace(start.execution(), run);
    threads_.emplace_back();
    Thread& thread = threads_.back();
    thread.thread = std::thread(
        [this, run, &thread, function = skill->second.function, id = start.execution()] {
          SkillEnd end;
          try {
            end = function(*run);
          } catch (const std::exception& failure) {
            end = SkillEnd::failure(failure.what());
          } catch (...) {
            end = SkillEnd::failure("an unknown exception");
          }
          // If the server is gone, it has ended the execution by itself.
          if (const Status said = run->end(end); !said.ok())
            log::debug("provider '{}': {}", name_, said.message());
          const MutexLock done(mutex_);
          runs_.erase(id);
          thread.is_over = true;
          changed_.notify_all();
        });
  }

  /// Joins the threads of executions that are over, or of all.
  void join_runs(bool waits) {
    std::list<Thread> over;
    {
      const MutexLock lock(mutex_);
      if (waits) changed_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) { return runs_.empty(); });
      for (auto one = threads_.begin(); one != threads_.end();)
        if (one->is_over)
          over.splice(over.end(), threads_, one++);
        else
          ++one;
    }
    for (Thread& one : over) one.thread.join();
  }

  void stop_all(const std::string& reason) {
    std::vector<std::shared_ptr<RemoteRun>> runs;
    {
      const MutexLock lock(mutex_);
      for (const auto& [id, run] : runs_) runs.push_back(run);
    }
    for (const auto& run : runs) run->stop_for(reason);
  }

  void keep_connected() {
    while (true) {
      {
        const MutexLock lock(mutex_);
        changed_.wait(mutex_, [this]() ENGRAM_REQUIRES(mutex_) { return is_ending_ || !is_open_; });
        if (is_ending_) return;
        log::info("provider '{}': the server is gone ({}); it is tried again", name_,
                  end_status_.message());
      }
      stop_all("the server is gone");
      Status status = unavailable("not connected");
      while (!status.ok()) {
        {
          const MutexLock lock(mutex_);
          if (changed_.wait_for(mutex_, kConnectAgainAfter,
                                [this]() ENGRAM_REQUIRES(mutex_) { return is_ending_; }))
            return;
        }
        status = open();
        if (!status.ok() && status.code() != StatusCode::kUnavailable &&
            status.code() != StatusCode::kAlreadyExists && status.message() != last_problem_)
          log::warning("provider '{}': {}", name_, status.message());
        last_problem_ = status.message();
      }
      log::info("provider '{}': connected again", name_);
    }
  }

  const std::string endpoint_;
  const std::string name_;
  const ConnectOptions options_;

  /// By endpoint. They must outlive their streams. Used by one thread at a time: the one that
  /// connects.
  std::map<std::string, std::shared_ptr<grpc::Channel>> channels_;
  server::OpenStreams streams_;
  mutable Mutex mutex_;
  Mutex telling_;  ///< One change at a time waits for its answer.
  ConditionVariable changed_;
  std::map<std::string, Skill> skills_ ENGRAM_GUARDED_BY(mutex_);
  std::map<std::string, std::shared_ptr<RemoteRun>> runs_ ENGRAM_GUARDED_BY(mutex_);
  std::list<Thread> threads_ ENGRAM_GUARDED_BY(mutex_);
  SharedStream stream_ ENGRAM_GUARDED_BY(mutex_);
  uint64_t generation_ ENGRAM_GUARDED_BY(mutex_) = 0;
  std::optional<Status> taken_ ENGRAM_GUARDED_BY(mutex_);
  Status end_status_ ENGRAM_GUARDED_BY(mutex_);
  bool is_open_ ENGRAM_GUARDED_BY(mutex_) = false;
  bool is_ending_ ENGRAM_GUARDED_BY(mutex_) = false;
  std::string last_problem_;  ///< Used by the thread alone.
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<SkillProvider>> SkillProvider::connect(const std::string& endpoint,
                                                              const std::string& name,
                                                              const ConnectOptions& options) {
  ENGRAM_RETURN_IF_ERROR(skills::check_name("provider", name));
  if (options.is_name_system && endpoint.empty())
    return invalid_argument("found no endpoint of a name system, needs one");
  auto provider = std::make_unique<RemoteProvider>(endpoint, name, options);
  ENGRAM_RETURN_IF_ERROR(provider->begin());
  return std::unique_ptr<SkillProvider>(std::move(provider));
}

}  // namespace engram
