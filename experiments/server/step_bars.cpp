// SPDX-License-Identifier: Apache-2.0
// Measures each step of working memory for the paper's three objects: a commit and a query of a
// server in a process of its own, the work of that server in them, and conversions.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "ltm/core/log.h"
#include "ltm/idf/binary.h"
#include "ltm/working/working_memory.h"
#include "paper_objects_example.h"
#include "server/age_roles.h"
#include "server/client/memory_client.h"

namespace engram::experiments {
namespace {

using benchmark_objects::example;
using nlohmann::json;

struct Arguments {
  int samples = 1000;
  int warm_up = 100;
  int rounds = 5;
  int entries = 1000;
  std::vector<int> batches{1, 20, 50, 100};
  std::string json;
  // Options of a child:
  std::string role;
  std::string endpoint;
};

[[noreturn]] void die(const Status& status) {
  std::cerr << "step_bars: " << status.to_string() << "\n";
  std::exit(1);
}

template <typename T>
T value_or_die(Result<T> result) {
  if (!result.ok()) die(result.status());
  return *std::move(result);
}

void or_die(const Status& status) {
  if (!status.ok()) die(status);
}

/// A memory server in a process of its own, which ends when this is destroyed.
class ServerProcess {
 public:
  explicit ServerProcess(const Arguments& arguments) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::string command = fmt::format("'{}' --role memory --endpoint '{}' --entries {}",
                                            program, arguments.endpoint, arguments.entries);
    pipe_ = ::popen(command.c_str(), "w");
    if (pipe_ == nullptr) die(unavailable("cannot start a process"));
  }
  ~ServerProcess() { ::pclose(pipe_); }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

 private:
  FILE* pipe_ = nullptr;  ///< The child ends when it is closed.
};

using Times = std::vector<int64_t>;

/// Adds the times of a step in one round. Unit: ns.
void sample(const Arguments& arguments, Times& times, const std::function<void()>& prepare,
            const std::function<void()>& step) {
  for (int i = 0; i < arguments.warm_up + arguments.samples / arguments.rounds; ++i) {
    prepare();
    const int64_t began = steady_ns();
    step();
    if (i >= arguments.warm_up) times.push_back(steady_ns() - began);
  }
}

/// Returns quartiles. Unit: ns.
json quartiles(Times times) {
  std::ranges::sort(times);
  const auto at = [&](size_t percent) { return times[(times.size() - 1) * percent / 100]; };
  return {{"median", at(50)}, {"low", at(25)}, {"high", at(75)}, {"samples", times.size()}};
}

/// Makes a commit of `batch` objects of this type, each of an entity of its own.
template <typename Object>
ltm::Commit commit_of(int batch, int64_t number) {
  static const idf::Data data = example<Object>().to_idf();
  ltm::Commit commit;
  for (int i = 0; i < batch; ++i)
    commit.updates.push_back({*ltm::MemoryId::parse(fmt::format("Bench/Object/producer/o{}", i)),
                              time_from_ns(number),
                              {{data, {}}}});
  return commit;
}

std::unique_ptr<ltm::WorkingMemory> filled_memory(int entries) {
  ltm::WorkingMemory::Options options;
  options.mode = ltm::StoreMode::kLatest;
  options.all.snapshots = static_cast<size_t>(entries);
  auto memory = value_or_die(ltm::WorkingMemory::create(options));
  for (int i = 0; i < entries; ++i) {
    auto commit = commit_of<benchmark_objects::Moderate>(1, i + 1);
    commit.updates[0].entity = *ltm::MemoryId::parse(fmt::format("Held/Object/before/{}", i % 100));
    or_die(memory->commit(std::move(commit)));
  }
  return memory;
}

template <typename Object>
void sample_conversion(const Arguments& arguments, int batch, Times& times) {
  const Object object = example<Object>();
  sample(
      arguments, times, [] {},
      [&] {
        for (int i = 0; i < batch; ++i) {
          const auto bytes = Buffer::take(value_or_die(idf::encode(object.to_idf())));
          const auto back = value_or_die(Object::from_idf(value_or_die(idf::decode(bytes))));
          asm volatile("" : : "r"(&back) : "memory");
        }
      });
}

/// Measures the steps of one object and batch. The memories hold `entries` snapshots before.
template <typename Object>
json measure(const Arguments& arguments, int batch) {
  const auto query = value_or_die(ltm::Query::parse("Bench/Object/producer/.* @ latest"));
  int64_t now = to_ns(system_now());
  ltm::Commit commit;
  const auto make = [&] { commit = commit_of<Object>(batch, ++now); };
  std::map<std::string, Times> times;
  // Each round has a new server, because threads tend to stay on the cores where they started.
  for (int round = 0; round < arguments.rounds; ++round) {
    const ServerProcess process(arguments);
    const auto client = value_or_die(server::MemoryClient::connect(arguments.endpoint));
    sample(arguments, times["commit"], make, [&] { or_die(client->commit(commit)); });
    sample(
        arguments, times["query"], [] {},
        [&] {
          const auto answer = value_or_die(client->query(query));
          if (answer.snapshot_count() != static_cast<size_t>(batch))
            die(data_loss("query: found {} snapshots, needs {}", answer.snapshot_count(), batch));
        });
  }
  for (int round = 0; round < arguments.rounds; ++round) {
    const auto memory = filled_memory(arguments.entries);
    sample(arguments, times["storage"], make, [&] { or_die(memory->commit(std::move(commit))); });
    sample(
        arguments, times["look-up"], [] {},
        [&] {
          if (memory->select(query).size() != static_cast<size_t>(batch))
            die(data_loss("look-up: needs {} entities", batch));
        });
    sample_conversion<Object>(arguments, batch, times["conversion"]);
  }
  json steps;
  for (auto& [name, found] : times) steps[name] = quartiles(std::move(found));
  return steps;
}

int run_bars(Arguments& arguments) {
  std::string folder = "/tmp/engram-steps-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) die(unavailable("no folder"));
  arguments.endpoint = "unix:" + folder + "/memory";
  constexpr const char* kSteps[] = {"commit", "storage", "query", "look-up", "conversion"};
  std::cout << fmt::format("Median of {} in us\n\n{:>8} {:>5}", arguments.samples, "object",
                           "batch");
  for (const char* step : kSteps) std::cout << fmt::format(" {:>11}", step);
  std::cout << std::endl;
  json report = json::array();
  const auto show = [&](const char* object, int batch, json steps) {
    std::cout << fmt::format("{:>8} {:>5}", object, batch);
    for (const char* step : kSteps)
      std::cout << fmt::format(" {:>11.1f}", steps[step]["median"].get<double>() / 1e3);
    std::cout << std::endl;
    report.push_back({{"object", object}, {"batch", batch}, {"steps", std::move(steps)}});
  };
  for (const int batch : arguments.batches) {
    show("simple", batch, measure<benchmark_objects::Simple>(arguments, batch));
    show("moderate", batch, measure<benchmark_objects::Moderate>(arguments, batch));
    show("complex", batch, measure<benchmark_objects::Complex>(arguments, batch));
  }
  std::error_code failed;
  std::filesystem::remove_all(folder, failed);
  if (!arguments.json.empty())
    std::ofstream(arguments.json) << json{{"steps_ns", report}}.dump(2) << "\n";
  return 0;
}

int run_memory(const Arguments& arguments) {
  const auto role = value_or_die(start_memory(arguments.endpoint, arguments.entries));
  std::string line;
  while (std::getline(std::cin, line)) {
  }
  return 0;
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  using namespace engram::experiments;
  engram::log::set_level(engram::log::Level::kError);
  Arguments arguments;
  CLI::App app{"What each step of working memory takes for the paper's three objects"};
  app.add_option("--samples", arguments.samples, "Of each step, object and batch")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--warm-up", arguments.warm_up, "Before them, of each round")
      ->capture_default_str();
  app.add_option("--rounds", arguments.rounds, "Of new servers, which share the samples")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--entries", arguments.entries, "Snapshots that the memory holds before")
      ->capture_default_str();
  app.add_option("--batches", arguments.batches, "Objects in one commit")->capture_default_str();
  app.add_option("--json", arguments.json, "Write the figures there");
  app.add_option("--role", arguments.role)->group("");
  app.add_option("--endpoint", arguments.endpoint)->group("");
  CLI11_PARSE(app, argc, argv);
  return arguments.role == "memory" ? run_memory(arguments) : run_bars(arguments);
}
