// SPDX-License-Identifier: Apache-2.0
// Measures what two cameras cost that nobody attends to, and whether attention that opens finds
// what came before. Server, provider and subscriber are processes of their own.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "ltm/core/log.h"
#include "server/client/memory_client.h"
#include "server/robot/memory_server.h"
#include "server/role_process.h"

namespace engram::experiments {
namespace {

using nlohmann::json;
using std::chrono::duration_cast;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr int64_t kHeight = 480;
constexpr int64_t kWidth = 640;
constexpr size_t kImageBytes = kHeight * kWidth * 3;
constexpr const char* kEyes[] = {"Vision/RGB/head/left", "Vision/RGB/head/right"};

struct Arguments {
  double rate_hz = 20;
  double seconds = 30;
  int openings = 30;
  double hold_ms = 500;
  std::string json;
  std::string role;      ///< Of a child.
  std::string endpoint;  ///< Of a child.
};

[[noreturn]] void die(const Status& status) {
  std::cerr << "sensory_bars: " << status.to_string() << "\n";
  std::exit(1);
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<size_t>(share * last + 0.5)];
}

json times_of(const std::vector<double>& values) {
  return {{"count", values.size()},
          {"p50_us", percentile(values, 0.5)},
          {"p99_us", percentile(values, 0.99)},
          {"max_us", percentile(values, 1)}};
}

/// The arguments of a process in another role.
std::vector<std::string> words_of(const Arguments& arguments, const std::string& role,
                                  const std::string& endpoint) {
  return {"--role",     role,
          "--endpoint", endpoint,
          "--rate",     std::to_string(arguments.rate_hz),
          "--hold",     std::to_string(arguments.hold_ms)};
}

json answer_of(RoleProcess& process) {
  return json::parse(process.answer());
}

// --- The children ---

int serve(const Arguments& arguments) {
  server::MemoryServer::Options options;
  options.service.name = "bars";
  options.service.store.emplace();
  options.service.store->store =
      std::filesystem::path(arguments.endpoint.substr(5)).parent_path() / "bars.engram";
  options.service.memory.mode = ltm::StoreMode::kEverything;
  options.service.sensory.segments = {
      {*ltm::MemoryId::parse("Vision/RGB"),
       duration_cast<Duration>(std::chrono::duration<double, std::milli>(arguments.hold_ms))}};
  options.rpc.endpoints = {*server::Endpoint::parse(arguments.endpoint)};
  auto started = server::MemoryServer::start(options, nullptr);
  if (!started.ok()) die(started.status());
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    const auto counters = (*started)->service().counters();
    const memory::SensoryCounts& sensory = *counters.sensory;
    std::cout << json{{"committed", sensory.committed},
                      {"passed", sensory.passed},
                      {"refused", sensory.refused},
                      {"lost", sensory.lost()},
                      {"crowded_out", sensory.crowded_out},
                      {"held", sensory.held},
                      {"held_bytes", sensory.held_bytes},
                      {"memory_bytes", counters.memory.bytes},
                      {"memory_committed", counters.memory.committed},
                      {"stored", counters.store->recorded}}
                     .dump()
              << std::endl;
  }
  return 0;
}

/// Two images, at the same time.
ltm::Commit stereo_at(Time time, const std::array<idf::Data, 2>& images) {
  ltm::Commit commit;
  for (size_t eye = 0; eye < 2; ++eye)
    commit.updates.push_back({*ltm::MemoryId::parse(kEyes[eye]), time, {{images[eye], {}}}});
  return commit;
}

/// Commits at the rate, each beside a copy of the same bytes, for as long as each line says. A line
/// is seconds, and "lend" where the pixels are written into memory that is lent for the commit; the
/// answer has the times of all commits and what they took.
int provide(const Arguments& arguments) {
  auto client = server::MemoryClient::connect(arguments.endpoint);
  if (!client.ok()) die(client.status());
  // As a driver's buffers: the pixels are new each time, their memory is not.
  std::array<std::vector<uint8_t>, 2> pixels;
  std::array<idf::Data, 2> images;
  for (size_t eye = 0; eye < 2; ++eye) {
    pixels[eye].resize(kImageBytes);
    images[eye] = *idf::NdArray::create(
        idf::NdArray::take({1}, std::vector<uint8_t>(1)).type(), {kHeight, kWidth, 3},
        Buffer(std::shared_ptr<const void>(&pixels[eye], [](const void*) {}),
               std::as_bytes(std::span(pixels[eye]))));
  }
  uint8_t grey = 0;
  const auto see = [&] {
    ++grey;
    for (auto& image : pixels) std::ranges::fill(image, grey);
  };
  // As many places as a ring has for what it holds.
  std::vector<std::vector<uint8_t>> copies(
      static_cast<size_t>(arguments.hold_ms / 1e3 * arguments.rate_hz) + 2,
      std::vector<uint8_t>(2 * kImageBytes));
  std::cout << "ready" << std::endl;
  const auto us = [](SteadyTime begin, SteadyTime end) {
    return std::chrono::duration<double, std::micro>(end - begin).count();
  };
  std::vector<server::ArrayToLend> lent;
  for (const char* eye : kEyes)
    lent.push_back({*ltm::MemoryId::parse(eye), idf::ElementType::kUInt8, {kHeight, kWidth, 3}});
  for (std::string line; std::getline(std::cin, line);) {
    const bool lends = line.ends_with("lend");
    const SteadyTime end =
        steady_now() + duration_cast<Duration>(std::chrono::duration<double>(std::stod(line)));
    const auto period =
        duration_cast<Duration>(std::chrono::duration<double>(1 / arguments.rate_hz));
    json commits = json::array();
    std::vector<double> took;
    std::vector<double> copied;
    std::vector<double> lending;
    for (SteadyTime next = steady_now(); next < end; next += period) {
      std::this_thread::sleep_until(next);
      std::optional<server::Loan> loan;
      if (lends) {
        const SteadyTime asked = steady_now();
        auto made = (*client)->lend(lent);
        if (!made.ok()) die(made.status());
        lending.push_back(us(asked, steady_now()));
        loan = *std::move(made);
        if (!loan->is_in_ring()) die(unavailable("no room was lent"));
        ++grey;
        for (size_t eye = 0; eye < 2; ++eye) std::ranges::fill(loan->bytes(eye), std::byte(grey));
      } else {
        see();
      }
      const Time time = system_now();
      const ltm::Commit commit =
          loan ? stereo_at(time, {loan->array(0), loan->array(1)}) : stereo_at(time, images);
      const SteadyTime begin = steady_now();
      if (const Status status = (*client)->commit(commit); !status.ok()) die(status);
      const SteadyTime done = steady_now();
      took.push_back(us(begin, done));
      commits.push_back({to_ns(time), to_ns(system_now())});
      std::this_thread::sleep_for(period / 2);
      see();
      std::vector<uint8_t>& copy = copies[took.size() % copies.size()];
      const SteadyTime copying = steady_now();
      for (size_t eye = 0; eye < 2; ++eye)
        std::memcpy(copy.data() + eye * kImageBytes, pixels[eye].data(), kImageBytes);
      copied.push_back(us(copying, steady_now()));
    }
    std::cout << json{{"commits", commits},
                      {"took", took},
                      {"copied", copied},
                      {"lending", lending}}
                     .dump()
              << std::endl;
  }
  return 0;
}

/// Subscribes for as many seconds as a line says; the answer has when it began and was in place,
/// and the times that were told.
int subscribe(const Arguments& arguments) {
  auto client = server::MemoryClient::connect(arguments.endpoint);
  if (!client.ok()) die(client.status());
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    std::mutex mutex;
    json told = json::array();
    SubscriptionHandlers handlers;
    handlers.on_snapshots = [&](const std::vector<ToldSnapshot>& snapshots) {
      const std::scoped_lock lock(mutex);
      for (const ToldSnapshot& one : snapshots)
        if (one.snapshot.entity.to_string() == kEyes[0]) told.push_back(to_ns(one.snapshot.time));
    };
    const int64_t begin = to_ns(system_now());
    auto subscription =
        (*client)->subscribe({.names = {"Vision/RGB"}, .with_data = true}, handlers);
    if (!subscription.ok()) die(subscription.status());
    const int64_t opened = to_ns(system_now());
    std::this_thread::sleep_for(std::chrono::duration<double>(std::stod(line)));
    const int64_t ending = to_ns(system_now());
    // What was committed until now is told soon.
    std::this_thread::sleep_for(milliseconds(100));
    subscription->reset();
    const std::scoped_lock lock(mutex);
    std::cout
        << json{{"begin", begin}, {"opened", opened}, {"ending", ending}, {"told", told}}.dump()
        << std::endl;
  }
  return 0;
}

// --- The measurement ---

void say(const char* what, const json& times) {
  std::cout << fmt::format("  {:<34} p50 {:8.1f} us   p99 {:8.1f} us   max {:8.1f} us   ({})\n",
                           what, times["p50_us"].get<double>(), times["p99_us"].get<double>(),
                           times["max_us"].get<double>(), times["count"].get<int>());
}

int run_bars(const Arguments& arguments) {
  std::string folder = "/tmp/engram-sensory-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) die(unavailable("no folder"));
  const std::string endpoint = "unix:" + folder + "/s";
  json report;
  int missed = 0;
  const auto bar = [&missed](const char* what, double found, double max) {
    missed += found > max;
    std::cout << fmt::format("  {:<34} {:.1f} ({:.0f})  {}\n", what, found, max,
                             found <= max ? "reached" : "MISSED");
  };
  {
    RoleProcess memory(words_of(arguments, "memory", endpoint));
    RoleProcess provider(words_of(arguments, "provider", endpoint));
    RoleProcess subscriber(words_of(arguments, "subscriber", endpoint));
    std::cout << fmt::format("Two images of {} x {} x 3, {:.0f} Hz, held {:.0f} ms\n", kWidth,
                             kHeight, arguments.rate_hz, arguments.hold_ms);
    // The pages of a ring are new once.
    provider.tell("2");
    json warm = answer_of(provider);
    report["first_seconds"] = times_of(warm["took"].get<std::vector<double>>());
    say("commit, the first two seconds", report["first_seconds"]);
    provider.tell(std::to_string(arguments.seconds));
    json found = answer_of(provider);
    report["unattended"] = times_of(found["took"].get<std::vector<double>>());
    report["memcpy"] = times_of(found["copied"].get<std::vector<double>>());
    memory.tell("");
    report["after_unattended"] = answer_of(memory);
    say("commit, nobody attends", report["unattended"]);
    say("memcpy of the same bytes", report["memcpy"]);
    const double stored = report["after_unattended"]["stored"].get<double>() +
                          report["after_unattended"]["memory_bytes"].get<double>();
    bar("bytes stored or in working memory", stored, 0);
    bar("commit p99, us", report["unattended"]["p99_us"].get<double>(), 100);
    std::cout << fmt::format(
        "  {:<34} {:.2f} at p50, {:.2f} at p99\n", "commit over memcpy",
        report["unattended"]["p50_us"].get<double>() / report["memcpy"]["p50_us"].get<double>(),
        report["unattended"]["p99_us"].get<double>() / report["memcpy"]["p99_us"].get<double>());
    provider.tell(std::to_string(arguments.seconds) + " lend");
    found = answer_of(provider);
    report["lent"] = times_of(found["took"].get<std::vector<double>>());
    report["lending"] = times_of(found["lending"].get<std::vector<double>>());
    say("to lend room for both images", report["lending"]);
    say("commit of what was written there", report["lent"]);
    bar("commit p99 of what was lent, us", report["lent"]["p99_us"].get<double>(), 100);
    // Attention opens and closes while the provider goes on.
    const double attended_s = 0.4;
    const double pause_s = 0.75;
    provider.tell(std::to_string(arguments.openings * (attended_s + pause_s + 0.2) + 2));
    std::vector<json> attentions;
    std::this_thread::sleep_for(milliseconds(700));
    for (int i = 0; i < arguments.openings; ++i) {
      subscriber.tell(std::to_string(attended_s));
      attentions.push_back(answer_of(subscriber));
      std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
    }
    found = answer_of(provider);
    std::vector<std::pair<int64_t, int64_t>> commits;
    for (const auto* all : {&warm["commits"], &found["commits"]})
      for (const auto& one : *all) commits.emplace_back(one[0], one[1]);
    int missing = 0;
    int twice = 0;
    int expected = 0;
    std::vector<double> opening;
    const auto hold = static_cast<int64_t>(arguments.hold_ms * 1e6);
    for (const json& attention : attentions) {
      std::vector<int64_t> told = attention["told"];
      if (!std::ranges::is_sorted(told)) ++twice;
      twice += static_cast<int>(told.end() - std::unique(told.begin(), told.end()));
      opening.push_back((attention["opened"].get<double>() - attention["begin"].get<double>()) /
                        1e3);
      for (const auto& [time, done] : commits) {
        // Held when attention opened, at the latest, and done when it ended.
        if (done < attention["opened"].get<int64_t>() - hold || done > attention["ending"])
          continue;
        ++expected;
        missing += std::ranges::find(told, time) == told.end();
      }
    }
    report["opening"] = times_of(opening);
    say("attention opens with what is held", report["opening"]);
    memory.tell("");
    report["at_the_end"] = answer_of(memory);
    std::cout << fmt::format("  snapshots of one eye that attention must tell of: {}\n", expected);
    bar("of these missing", missing, 0);
    bar("told twice or out of order", twice, 0);
    report["expected"] = expected;
    report["missing"] = missing;
    report["twice"] = twice;
    // All the time.
    subscriber.tell(std::to_string(arguments.seconds / 3 + 1));
    std::this_thread::sleep_for(milliseconds(500));
    provider.tell(std::to_string(arguments.seconds / 3));
    report["attended"] = times_of(answer_of(provider)["took"].get<std::vector<double>>());
    answer_of(subscriber);
    say("commit, somebody attends", report["attended"]);
    std::cout << "  " << report["at_the_end"].dump() << "\n";
  }
  std::filesystem::remove_all(folder);
  if (!arguments.json.empty()) std::ofstream(arguments.json) << report.dump(2);
  return missed == 0 ? 0 : 1;
}

int run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("What sensory memory costs, and whether opening attention is complete.");
  app.add_option("--rate", arguments.rate_hz, "pairs of images a second");
  app.add_option("--seconds", arguments.seconds, "how long nobody attends");
  app.add_option("--openings", arguments.openings, "how often attention opens");
  app.add_option("--hold", arguments.hold_ms, "ms that a segment is held");
  app.add_option("--json", arguments.json, "file for what was measured");
  app.add_option("--role", arguments.role)->group("");
  app.add_option("--endpoint", arguments.endpoint)->group("");
  CLI11_PARSE(app, argc, argv);
  log::set_level(log::Level::kError);
  if (arguments.role == "memory") return serve(arguments);
  if (arguments.role == "provider") return provide(arguments);
  if (arguments.role == "subscriber") return subscribe(arguments);
  return run_bars(arguments);
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  return engram::experiments::run(argc, argv);
}
