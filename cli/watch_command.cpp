// SPDX-License-Identifier: Apache-2.0
#include <deque>

#include "cli/interrupt.h"
#include "cli/remote.h"
#include "cli/server_commands.h"
#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/core/printable.h"
#include "ltm/idf/json.h"
#include "ltm/memory/augmentation_json.h"
#include "reports/plain/result_text.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr const char* kWatchFooter =
    R"(Prints a line for each snapshot that is committed from now on, until Ctrl-C: its ID, and with --data
what it holds. NAMES are those of queries, Memory/Core/Provider/Entity, each a name or a regular
expression; missing ones match all. Where this is too slow for what comes, it says how many
snapshots it was not told of, and ends with exit code 3.

Examples:
  engram watch
  engram watch Vision 'Robot/.*/.*/joints' --data
  engram watch --server 127.0.0.1:50051 Vision --count 10 --json
  engram watch Vision --data --json | engram commit --server 10.0.0.2:50051 --lines -)";

/// The max number of snapshots that wait to be printed. Further ones wait at the server, which
/// bounds them.
constexpr size_t kMaxWaiting = 4096;

struct WatchArguments {
  RemoteArguments remote;
  std::vector<std::string> names;
  uint64_t count = 0;
  bool with_data = false;
  bool is_json = false;
};

Result<Json> line_json(const ltm::Snapshot& snapshot, bool with_data) {
  Json json{{"id", snapshot.id().to_string()}, {"time_ns", to_ns(snapshot.time)}};
  if (!with_data) {
    json["instance_count"] = snapshot.instances.size();
    return json;
  }
  json["instances"] = Json::array();
  for (const ltm::Instance& instance : snapshot.instances) {
    ENGRAM_ASSIGN_OR_RETURN(Json data, idf::to_json(instance.data));
    Json entry{{"created_ns", to_ns(instance.metadata.created)},
               {"provider", instance.metadata.provider},
               {"confidence", instance.metadata.confidence}};
    entry.update(ltm::augmentation_json(instance.metadata));
    entry["data"] = std::move(data);
    json["instances"].push_back(std::move(entry));
  }
  return json;
}

Result<std::string> line_of(const ltm::Snapshot& snapshot, const WatchArguments& arguments) {
  if (arguments.is_json) {
    ENGRAM_ASSIGN_OR_RETURN(const Json json, line_json(snapshot, arguments.with_data));
    return printable_json(json.dump());
  }
  std::string text = snapshot.id().printable();
  if (arguments.with_data) text += "  " + printable(reports::content_text(snapshot));
  return text;
}

/// Snapshots received from servers and not printed yet.
class Inbox {
 public:
  SubscriptionHandlers handlers() {
    return {[this](std::vector<ToldSnapshot> told) { put(std::move(told)); },
            [this](uint64_t lost) { lose(lost); },
            [](const Status& status) {
              log::warning("{}; what came meanwhile was not told", status.message());
            }};
  }

  /// Waits for the next snapshot; returns nothing if a stop is requested.
  std::optional<ltm::Snapshot> next(const std::stop_token& stop) {
    const MutexLock lock(mutex_);
    if (!changed_.wait(mutex_, stop,
                       [this]() ENGRAM_REQUIRES(mutex_) { return !waiting_.empty(); }))
      return std::nullopt;
    ltm::Snapshot snapshot = std::move(waiting_.front());
    waiting_.pop_front();
    return snapshot;
  }

  [[nodiscard]] uint64_t lost() const {
    const MutexLock lock(mutex_);
    return lost_;
  }

 private:
  void put(std::vector<ToldSnapshot> told) {
    const MutexLock lock(mutex_);
    for (ToldSnapshot& one : told) waiting_.push_back(std::move(one.snapshot));
    // The oldest are dropped, as in the server's queue: a slow reader sees the newest.
    for (; waiting_.size() > kMaxWaiting; ++lost_) waiting_.pop_front();
    changed_.notify_one();
  }

  void lose(uint64_t count) {
    const MutexLock lock(mutex_);
    lost_ += count;
  }

  mutable Mutex mutex_;
  StoppableCondition changed_;
  std::deque<ltm::Snapshot> waiting_ ENGRAM_GUARDED_BY(mutex_);
  uint64_t lost_ ENGRAM_GUARDED_BY(mutex_) = 0;
};

ExitCode print_all(Inbox& inbox, const WatchArguments& arguments) {
  finish_after_interrupt();
  for (uint64_t shown = 0; arguments.count == 0 || shown < arguments.count; ++shown) {
    const auto snapshot = inbox.next(interrupt_token());
    if (!snapshot) break;
    const auto line = line_of(*snapshot, arguments);
    if (!line.ok()) return fail(line.status());
    print_now(*line);
  }
  if (inbox.lost() == 0) return ExitCode::kDone;
  log::warning("{} snapshots were not told: they came faster than they were read",
               reports::count_text(inbox.lost()));
  return ExitCode::kDoneWithLoss;
}

ExitCode run(const WatchArguments& arguments) {
  if (const Status named = check_source("", arguments.remote); !named.ok())
    return wrong_usage(named);
  for (const std::string& names : arguments.names)
    if (const auto query = ltm::Query::parse(names); !query.ok())
      return wrong_usage(query.status());
  const auto memory = connect_memory(arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  Inbox inbox;
  const auto subscription = (*memory)->subscribe(
      {.names = arguments.names, .with_data = arguments.with_data}, inbox.handlers());
  if (!subscription.ok()) return fail(subscription.status());
  log::info("watching");
  return print_all(inbox, arguments);
}

}  // namespace

void add_watch_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<WatchArguments>();
  CLI::App* command = app.add_subcommand("watch", "Print what is committed to a server");
  command->footer(kWatchFooter);
  command->add_option("names", arguments->names, "Entities, as in queries; else all");
  command->add_flag("--data", arguments->with_data, "What they hold, too");
  command->add_option("--count", arguments->count, "End after so many snapshots");
  command->add_flag("--json", arguments->is_json, "A line of JSON each");
  add_remote_options(*command, arguments->remote);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
