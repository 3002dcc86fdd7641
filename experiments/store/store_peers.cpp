// SPDX-License-Identifier: Apache-2.0
// What else could a user pick? Stores one stream in Engram, ROS 1 bags, HDF5 and SQLite, and
// measures bytes, the speed of writing, and the time to find one image.
#include <algorithm>
#include <functional>

#include "store/peer_run.h"
#include "store/report.h"
#include "store/stream_options.h"

namespace engram::experiments {
namespace {

struct Arguments {
  StreamOptions stream{.seconds = 40, .dir = "bars/peers"};
  size_t reads = 1000;
  std::vector<std::string> peers;
};

/// Runs one peer in a folder.
using RunPeer = std::function<Result<PeerFigures>(const Stream&, const std::vector<ImageRead>&,
                                                  const std::filesystem::path&)>;
struct Choice {
  const char* word;
  RunPeer run;
};

template <typename Make, typename... Options>
RunPeer runner(const Make& make, Options... options) {
  return [=](const Stream& stream, const std::vector<ImageRead>& reads,
             const std::filesystem::path& folder) {
    return run_peer(*make(options...), stream, reads, folder);
  };
}

std::vector<Choice> all_choices() {
  return {{"engram", runner(make_engram_peer)},
          {"bag", runner(make_bag_peer, BagCompression::kNone)},
          {"bag-lz4", runner(make_bag_peer, BagCompression::kLz4)},
          {"bag-bz2", runner(make_bag_peer, BagCompression::kBz2)},
          {"h5py", run_h5py},
          {"sqlite", runner(make_sqlite_peer, false)},
          {"sqlite-zstd", runner(make_sqlite_peer, true)}};
}

/// Returns "1.35 (0.92x)": a figure and its ratio to that of the first peer.
std::string ratio(const char* form, double value, double first) {
  return fmt::format(fmt::runtime(form), value) + fmt::format(" ({:.2f}x)", value / first);
}

void print_table(const std::vector<PeerFigures>& peers, double raw_bytes) {
  TextTable table({"peer", "MB", "% of raw", "write MB/s", "MB/s per core", "then to disk s",
                   "read median ms", "read p99 ms"});
  const PeerFigures& first = peers.front();
  const auto speed = [&](double seconds) { return raw_bytes / 1e6 / seconds; };
  for (const PeerFigures& it : peers)
    table.add({it.name,
               ratio("{:.1f}", static_cast<double>(it.disk_bytes) / 1e6,
                     static_cast<double>(first.disk_bytes) / 1e6),
               fmt::format("{:.1f}", 100 * static_cast<double>(it.disk_bytes) / raw_bytes),
               ratio("{:.0f}", speed(it.write_seconds), speed(first.write_seconds)),
               fmt::format("{:.0f}", speed(it.write_cpu_seconds)),
               fmt::format("{:.2f}", it.sync_seconds),
               ratio("{:.2f}", 1e3 * it.read.median, 1e3 * first.read.median),
               ratio("{:.2f}", 1e3 * it.read.p99, 1e3 * first.read.p99)});
  fmt::print("\n{}", table.to_string());
}

/// Prints where the first peer is not the best.
void print_losses(const std::vector<PeerFigures>& peers) {
  const PeerFigures& first = peers.front();
  for (const PeerFigures& it : peers) {
    std::string lost;
    if (it.disk_bytes < first.disk_bytes) lost += " bytes";
    if (it.write_seconds < first.write_seconds) lost += " writing";
    if (it.read.median < first.read.median) lost += " median-read";
    if (it.read.p99 < first.read.p99) lost += " p99-read";
    if (!lost.empty()) fmt::print("{} is ahead of {} in:{}\n", it.name, first.name, lost);
  }
}

nlohmann::json to_json(const PeerFigures& it) {
  return {{"name", it.name},
          {"disk_bytes", it.disk_bytes},
          {"write_seconds", it.write_seconds},
          {"write_cpu_seconds", it.write_cpu_seconds},
          {"sync_seconds", it.sync_seconds},
          {"read", experiments::to_json(it.read)}};
}

Result<std::vector<PeerFigures>> run_all(const Arguments& arguments, const Stream& stream) {
  const std::vector<ImageRead> reads = draw_reads(stream, arguments.reads);
  std::vector<PeerFigures> peers;
  for (const Choice& choice : all_choices()) {
    if (!arguments.peers.empty() &&
        std::ranges::find(arguments.peers, choice.word) == arguments.peers.end())
      continue;
    const auto folder = std::filesystem::path(arguments.stream.dir) / choice.word;
    ENGRAM_ASSIGN_OR_RETURN(PeerFigures figures, choice.run(stream, reads, folder));
    ENGRAM_RETURN_IF_ERROR(make_empty(folder));
    fmt::print("{}: written in {:.1f} s, {} reads exact\n", figures.name, figures.write_seconds,
               reads.size());
    std::fflush(stdout);
    peers.push_back(std::move(figures));
  }
  return peers;
}

Status run(const Arguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(StreamSource source, load_stream_source(arguments.stream.frames));
  const Stream stream(std::move(source), arguments.stream.seconds);
  const double raw_bytes = static_cast<double>(stream.raw_bytes());
  fmt::print("stream: {}; {:.0f} s, {:.3f} MB/s raw\n", stream.description(), stream.seconds(),
             raw_bytes / 1e6 / stream.seconds());
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<PeerFigures> peers, run_all(arguments, stream));
  print_table(peers, raw_bytes);
  print_losses(peers);
  nlohmann::json json{{"stream", stream.description()}, {"raw_bytes", stream.raw_bytes()}};
  for (const PeerFigures& it : peers) json["peers"].push_back(to_json(it));
  return write_json(arguments.stream.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  engram::experiments::Arguments arguments;
  CLI::App app(
      "Compares Engram with what else could store a robot's stream. ENGRAM_RECORDINGS"
      " names a folder of videos; without it a scene is rendered.");
  arguments.stream.add_to(app);
  app.add_option("--reads", arguments.reads, "of one image at a random time")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--peers", arguments.peers, "the ones to run, the first is compared with; all")
      ->delimiter(',')
      ->check(
          CLI::IsMember({"engram", "bag", "bag-lz4", "bag-bz2", "h5py", "sqlite", "sqlite-zstd"}));
  CLI11_PARSE(app, argc, argv);
  return engram::experiments::exit_code("store_peers", engram::experiments::run(arguments));
}
