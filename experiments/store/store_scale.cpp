// SPDX-License-Identifier: Apache-2.0
// Does a large store stay quick? Writes ten million small snapshots, then queries some of them in a
// new process.
#include <CLI/CLI.hpp>

#include "store/fresh_process.h"
#include "store/report.h"
#include "store/scale_reader.h"
#include "store/scale_writer.h"

namespace engram::experiments {
namespace {

constexpr double kOpenBar = 2;        // seconds
constexpr double kMemoryBar = 500e6;  // bytes
constexpr double kNearestBarMs = 1, kRangeBarMs = 5;

struct Arguments {
  uint64_t snapshots = 10000000;
  int entities = 20;
  int queries = 1000;
  bool keeps_store = false;
  std::string dir = "bars/scale";
  std::string json;
};

void print_written(const ScaleWorld& world, const nlohmann::json& written) {
  const double count = static_cast<double>(world.steps) * world.entities;
  const double seconds = written.at("seconds");
  fmt::print(
      "wrote {:.0f} snapshots of {} entities in {:.1f} s until closed (last seal {:.1f} s): "
      "{:.0f}/s,"
      " {:.2f} bytes each on disk,\n{} bytes of plain numbers each, peak memory {:.0f} MB,"
      " commits of {}: p50 {:.3f} ms, p99 {:.3f} ms, max {:.0f} ms\n",
      count, world.entities, seconds, written.at("close_seconds").get<double>(), count / seconds,
      written.at("bytes").get<double>() / count, ScaleWorld::kPlainBytes,
      written.at("memory_bytes").get<double>() / 1e6, world.entities,
      written.at("commit").at("median_ms").get<double>(),
      written.at("commit").at("p99_ms").get<double>(),
      written.at("commit").at("max_ms").get<double>());
}

std::string verdict_of(const std::string& name, double warm_ms, double cold_ms) {
  const double bar = name == "nearest" ? kNearestBarMs : name == "range of 100" ? kRangeBarMs : 0;
  if (bar == 0) return "";
  return fmt::format("{} warm, {} cold", verdict(warm_ms < bar), verdict(cold_ms < bar));
}

void print_read(const nlohmann::json& read) {
  const double open = read.at("open_seconds"), bytes = read.at("memory_bytes");
  fmt::print(
      "opened cold in {:.3f} s at most ({}); peak memory {:.0f} MB ({}); all answers right\n\n",
      open, verdict(open < kOpenBar), bytes / 1e6, verdict(bytes < kMemoryBar));
  TextTable table(
      {"question", "warm median ms", "p99", "cold median ms", "p99", "max", "bar, median"});
  for (const nlohmann::json& it : read.at("questions")) {
    const auto ms = [&](const char* round, const char* key) {
      return it.at(round).at(key).get<double>();
    };
    const double warm = ms("warm", "median_ms"), cold = ms("cold", "median_ms");
    table.add({it.at("name"), fmt::format("{:.3f}", warm),
               fmt::format("{:.3f}", ms("warm", "p99_ms")), fmt::format("{:.3f}", cold),
               fmt::format("{:.3f}", ms("cold", "p99_ms")),
               fmt::format("{:.1f}", ms("cold", "max_ms")), verdict_of(it.at("name"), warm, cold)});
  }
  fmt::print("{}", table.to_string());
}

Status run(const Arguments& arguments) {
  const ScaleWorld world{arguments.entities,
                         arguments.snapshots / static_cast<uint64_t>(arguments.entities)};
  if (world.steps < 100)
    return invalid_argument("--snapshots {}: needs 100 per entity", arguments.snapshots);
  const std::filesystem::path store = std::filesystem::path(arguments.dir) / "store";
  ENGRAM_ASSIGN_OR_RETURN(const nlohmann::json written,
                          in_fresh_process([&] { return write_scale(world, store); }));
  print_written(world, written);
  ENGRAM_ASSIGN_OR_RETURN(const nlohmann::json read, in_fresh_process([&] {
                            return read_scale(world, store, arguments.queries);
                          }));
  print_read(read);
  if (!arguments.keeps_store) ENGRAM_RETURN_IF_ERROR(make_empty(store));
  return write_json(arguments.json, {{"snapshots", world.steps * world.entities},
                                     {"entities", world.entities},
                                     {"written", written},
                                     {"read", read}});
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  engram::experiments::Arguments arguments;
  CLI::App app("Measures a store of many small snapshots.");
  app.add_option("--snapshots", arguments.snapshots, "of all entities")->capture_default_str();
  app.add_option("--entities", arguments.entities)
      ->check(CLI::Range(1, engram::experiments::ScaleWorld::kMaxEntities))
      ->capture_default_str();
  app.add_option("--queries", arguments.queries, "of each kind")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_flag("--keep", arguments.keeps_store, "leave the store");
  app.add_option("--dir", arguments.dir, "where the store is made anew")->capture_default_str();
  app.add_option("--json", arguments.json, "file for all figures");
  CLI11_PARSE(app, argc, argv);
  return engram::experiments::exit_code("store_scale", engram::experiments::run(arguments));
}
