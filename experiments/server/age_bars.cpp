// SPDX-License-Identifier: Apache-2.0
// Measures how much older data become on their way through the memory than on other ways. Each role
// runs in a process of its own.
#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <condition_variable>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "ltm/core/log.h"
#include "server/age_roles.h"
#include "server/role_process.h"

namespace engram::experiments {
namespace {

using nlohmann::json;

constexpr AgeWay kWays[] = {AgeWay::kDirect, AgeWay::kRelay, AgeWay::kMemory, AgeWay::kMemoryQuery};

struct Arguments {
  int samples = 1000;
  int warm_up = 100;
  int rounds = 5;
  bool has_subscribers = true;
  int entries = 1000;
  std::vector<int> batches{1, 20, 50, 100};
  std::vector<std::string> objects{"simple", "moderate", "complex"};
  std::string json;
  bool is_tuned = false;
  // Options of a child:
  std::string role;
  std::string endpoint;
  int way = 0;
  int object = 0;
  int batch = 1;
  int ages_fd = -1;
};

[[noreturn]] void die(const Status& status) {
  std::cerr << "age_bars: " << status.to_string() << "\n";
  std::exit(1);
}

/// The arguments of a process in another role.
std::vector<std::string> words_of(const Arguments& arguments, const std::string& role,
                                  const std::string& endpoint, AgeWay way, AgeObject object,
                                  int batch) {
  std::vector<std::string> words = {"--role",     role,
                                    "--endpoint", endpoint,
                                    "--way",      std::to_string(static_cast<int>(way)),
                                    "--object",   std::to_string(static_cast<int>(object)),
                                    "--batch",    std::to_string(batch),
                                    "--entries",  std::to_string(arguments.entries)};
  if (arguments.is_tuned) words.emplace_back("--tuned");
  return words;
}

/// The processes of one way.
struct Chain {
  std::unique_ptr<RoleProcess> middle;
  std::unique_ptr<RoleProcess> consumer;
  std::unique_ptr<RoleProcess> producer;
};

Chain start_chain(const Arguments& arguments, const std::string& folder, AgeWay way,
                  AgeObject object, int batch) {
  Chain chain;
  std::array<int, 2> ages{};
  if (::pipe2(ages.data(), O_CLOEXEC) != 0) die(unavailable("no pipe"));
  const std::string endpoint = "unix:" + folder + "/" + std::to_string(static_cast<int>(way));
  const auto start = [&](const char* role, int fd) {
    return std::make_unique<RoleProcess>(words_of(arguments, role, endpoint, way, object, batch),
                                         fd);
  };
  if (way != AgeWay::kDirect) chain.middle = start(way == AgeWay::kRelay ? "relay" : "memory", -1);
  chain.consumer = start("consumer", ages[1]);
  chain.producer = start("producer", ages[0]);
  ::close(ages[0]);
  ::close(ages[1]);
  return chain;
}

double median(std::vector<int64_t> values) {
  if (values.empty()) return 0;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return static_cast<double>(values[values.size() / 2]);
}

struct Found {
  std::vector<int64_t> ages;
  std::vector<int64_t> sends;
};

void sample(RoleProcess& producer, int count, Found* found) {
  const json answer = json::parse(producer.ask(std::to_string(count)));
  if (found == nullptr) return;
  for (const auto& age : answer["ages"]) found->ages.push_back(age);
  for (const auto& send : answer["sends"]) found->sends.push_back(send);
}

std::map<AgeWay, Found> measure(const Arguments& arguments, const std::string& folder,
                                AgeObject object, int batch) {
  std::map<AgeWay, Found> found;
  for (int round = 0; round < arguments.rounds; ++round) {
    // Each round has new processes, because threads tend to stay on the cores where they started.
    std::map<AgeWay, Chain> chains;
    for (const AgeWay way : kWays) {
      chains[way] = start_chain(arguments, folder, way, object, batch);
      sample(*chains[way].producer, arguments.warm_up, nullptr);
    }
    for (const AgeWay way : kWays)
      sample(*chains[way].producer, arguments.samples / arguments.rounds, &found[way]);
  }
  return found;
}

/// Measures the cost of a commit for its producer, by the number of subscribers. Rounds alternate.
json measure_subscribers(const Arguments& arguments, const std::string& folder) {
  const std::string endpoint = "unix:" + folder + "/subscribers";
  const auto start = [&](const char* role) {
    return std::make_unique<RoleProcess>(
        words_of(arguments, role, endpoint, AgeWay::kMemory, AgeObject::kModerate, 1));
  };
  const auto memory = start("memory");
  const auto producer = start("pacer");
  json result;
  std::map<int, std::vector<int64_t>> sends;
  for (int round = 0; round < arguments.rounds; ++round)
    for (const int count : {1, 2, 20}) {
      std::vector<std::unique_ptr<RoleProcess>> listeners;
      for (int i = 0; i < count; ++i) listeners.push_back(start("listener"));
      sample(*producer, 20, nullptr);
      Found found;
      sample(*producer, arguments.samples / arguments.rounds, &found);
      auto& all = sends[count];
      all.insert(all.end(), found.sends.begin(), found.sends.end());
    }
  const double one = median(sends[1]);
  std::cout << "\nA commit's time for its producer (one moderate object, 200 a second), by the "
               "number of subscribers\n";
  for (const auto& [count, times] : sends) {
    const double time = median(times);
    const double bar = count == 2 ? 1.1 : 1.6;
    std::cout << fmt::format("  {:>2}  {:8.1f} us  {:5.2f} x{}\n", count, time / 1e3, time / one,
                             count == 1          ? ""
                             : time / one <= bar ? fmt::format("  reached ({:.1f})", bar)
                                                 : fmt::format("  MISSED ({:.1f})", bar));
    result[std::to_string(count)] = time;
  }
  return result;
}

int run_bars(const Arguments& arguments) {
  std::string folder = "/tmp/engram-age-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) die(unavailable("no folder"));
  json report = json::array();
  int missed = 0;
  std::cout << fmt::format(
      "Age of data from producer to consumer, median of {} in {} rounds, us (and over direct, over "
      "relay)\n\n{:>8} {:>5} {:>16} {:>16} {:>26} {:>26}\n",
      arguments.samples, arguments.rounds, "object", "batch", "direct", "relay",
      "memory, data told", "memory, IDs told, query");
  for (const AgeObject object : {AgeObject::kSimple, AgeObject::kModerate, AgeObject::kComplex}) {
    if (std::ranges::find(arguments.objects, to_string(object)) == arguments.objects.end())
      continue;
    for (const int batch : arguments.batches) {
      auto found = measure(arguments, folder, object, batch);
      std::map<AgeWay, double> age;
      json row = {{"object", to_string(object)}, {"batch", batch}};
      for (const AgeWay way : kWays) {
        age[way] = median(found[way].ages);
        row[to_string(way)] = age[way];
      }
      const double direct = age[AgeWay::kDirect];
      const double relay = age[AgeWay::kRelay];
      std::string verdict;
      const auto bar = [&](const char* what, double ratio, double max) {
        missed += ratio > max;
        verdict += fmt::format("  {} {:.2f} ({:.2f}) {}", what, ratio, max,
                               ratio <= max ? "reached" : "MISSED");
      };
      if (object != AgeObject::kComplex && batch == 1) {
        bar("told/direct", age[AgeWay::kMemory] / direct, 2.9);
        bar("told/relay", age[AgeWay::kMemory] / relay, 1.1);
      }
      if (object != AgeObject::kComplex && batch == 1)
        bar("query/relay", age[AgeWay::kMemoryQuery] / relay, 2.2);
      if (object == AgeObject::kComplex && batch == 100)
        bar("told/direct", age[AgeWay::kMemory] / direct, 0.45);
      const auto over = [&](AgeWay way) {
        return fmt::format("{:.1f} ({:.2f}, {:.2f})", age[way] / 1e3, age[way] / direct,
                           age[way] / relay);
      };
      std::cout << fmt::format("{:>8} {:>5} {:>16.1f} {:>16} {:>26} {:>26}{}\n", to_string(object),
                               batch, direct / 1e3,
                               fmt::format("{:.1f} ({:.2f})", relay / 1e3, relay / direct),
                               over(AgeWay::kMemory), over(AgeWay::kMemoryQuery), verdict)
                << std::flush;
      report.push_back(std::move(row));
    }
  }
  const json subscribers =
      arguments.has_subscribers ? measure_subscribers(arguments, folder) : json::object();
  ::system(("rm -rf " + folder).c_str());
  if (!arguments.json.empty())
    std::ofstream(arguments.json) << json{{"ages_ns", report}, {"commit_ns", subscribers}}.dump(2);
  return missed == 0 ? 0 : 1;
}

// --- The children ---

void wait_for_end() {
  std::string line;
  while (std::getline(std::cin, line)) {
  }
}

void say_ready() {
  std::cout << "ready" << std::endl;
}

void produce(const Arguments& arguments, bool is_paced) {
  const auto way = static_cast<AgeWay>(arguments.way);
  const auto object = static_cast<AgeObject>(arguments.object);
  auto producer = start_producer(way, arguments.endpoint);
  if (!producer.ok()) die(producer.status());
  say_ready();
  std::string line;
  while (std::getline(std::cin, line)) {
    json ages = json::array();
    json sends = json::array();
    for (int i = std::stoi(line); i > 0; --i) {
      const ltm::Commit commit = make_commit(object, arguments.batch, system_now(), steady_ns());
      if (is_paced) {
        const auto time = (*producer)->acknowledged(commit);
        if (!time.ok()) die(time.status());
        sends.push_back(*time);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        continue;
      }
      if (const Status sent = (*producer)->send(commit); !sent.ok()) die(sent);
      int64_t age = 0;
      if (::read(RoleProcess::kShared, &age, sizeof(age)) != sizeof(age))
        die(unavailable("no consumer"));
      ages.push_back(age);
    }
    std::cout << json{{"ages", ages}, {"sends", sends}}.dump() << std::endl;
  }
}

int run_role(const Arguments& arguments) {
  log::set_level(log::Level::kError);
  const auto way = static_cast<AgeWay>(arguments.way);
  if (arguments.is_tuned) tune_plain_grpc();
  if (arguments.role == "producer" || arguments.role == "pacer") {
    produce(arguments, arguments.role == "pacer");
    return 0;
  }
  const auto tell = [](int64_t age) {
    if (::write(RoleProcess::kShared, &age, sizeof(age)) < 0) std::exit(1);
  };
  auto role = arguments.role == "memory"  ? start_memory(arguments.endpoint, arguments.entries)
              : arguments.role == "relay" ? start_relay(arguments.endpoint)
              : arguments.role == "listener"
                  ? start_consumer(way, arguments.endpoint, arguments.batch, [](int64_t) {})
                  : start_consumer(way, arguments.endpoint, arguments.batch, tell);
  if (!role.ok()) die(role.status());
  say_ready();
  wait_for_end();
  std::exit(0);
}

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"How much older data grow on their way through the memory"};
  app.add_option("--samples", arguments.samples, "Of each way, object and batch")
      ->capture_default_str();
  app.add_option("--warm-up", arguments.warm_up, "Before them, of each way and round")
      ->capture_default_str();
  app.add_option("--rounds", arguments.rounds, "In which the ways take turns")
      ->capture_default_str();
  app.add_option("--entries", arguments.entries, "Snapshots that the memory holds")
      ->capture_default_str();
  app.add_option("--batches", arguments.batches, "Objects in one commit")->capture_default_str();
  app.add_option("--objects", arguments.objects, "simple, moderate, complex")
      ->capture_default_str();
  app.add_flag("!--no-subscribers", arguments.has_subscribers,
               "Leaves out what subscribers cost a producer");
  app.add_flag("--tuned", arguments.is_tuned,
               "Direct and relay with as few polling threads as the memory, not as gRPC is");
  app.add_option("--json", arguments.json, "Write the figures there");
  app.add_option("--role", arguments.role)->group("");
  app.add_option("--endpoint", arguments.endpoint)->group("");
  app.add_option("--way", arguments.way)->group("");
  app.add_option("--object", arguments.object)->group("");
  app.add_option("--batch", arguments.batch)->group("");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  return arguments.role.empty() ? run_bars(arguments) : run_role(arguments);
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  // Without this, glibc maps and unmaps memory for each large message, on every way.
  ::mallopt(M_MMAP_THRESHOLD, 256 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 512 << 20);
  return engram::experiments::run(argc, argv);
}
