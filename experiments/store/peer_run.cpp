// SPDX-License-Identifier: Apache-2.0
#include "store/peer_run.h"

#include <algorithm>
#include <random>

#include "ltm/core/check.h"

namespace engram::experiments {

namespace {

Status write(Peer& peer, const Stream& stream, PeerFigures& figures) {
  double cpu = 0;
  const auto timed = [&](const auto& act) {
    const double cpu_before = cpu_seconds();
    const Stopwatch clock;
    Status status = act();
    figures.write_seconds += clock.seconds();
    cpu += cpu_seconds() - cpu_before;
    return status;
  };
  for (size_t i = 0; i < stream.ticks(); ++i) {
    ENGRAM_RETURN_IF_ERROR(peer.prepare(stream.tick(i)));
    ENGRAM_RETURN_IF_ERROR(timed([&] { return peer.append(); }));
  }
  ENGRAM_RETURN_IF_ERROR(timed([&] { return peer.close(); }));
  figures.write_cpu_seconds = cpu;
  return {};
}

Status read(Peer& peer, const Stream& stream, const std::vector<PeerRead>& reads,
            PeerFigures& figures) {
  std::vector<double> latencies;
  for (const PeerRead& it : reads) {
    const Tick tick = stream.tick(it.tick);
    const Stopwatch clock;
    ENGRAM_ASSIGN_OR_RETURN(const Buffer found, peer.image(it.camera, tick.time));
    latencies.push_back(clock.seconds());
    if (!std::ranges::equal(found.bytes(), tick.images[it.camera].bytes()))
      return data_loss("{}: image of camera {} at {} is not what was written", figures.name,
                       it.camera, to_string(tick.time));
  }
  figures.read = summarize(latencies);
  return {};
}

}  // namespace

std::vector<PeerRead> draw_reads(const Stream& stream, size_t count) {
  ENGRAM_CHECK(stream.ticks() > 0, "no ticks");
  const size_t images = (stream.ticks() - 1) / Stream::kTicksPerImage;
  std::mt19937_64 random(1);
  std::uniform_int_distribution<size_t> image(0, images), camera(0, kCameras.size() - 1);
  std::vector<PeerRead> reads;
  for (size_t i = 0; i < count; ++i)
    reads.push_back({camera(random), image(random) * Stream::kTicksPerImage});
  return reads;
}

Result<PeerFigures> run_peer(Peer& peer, const Stream& stream, const std::vector<PeerRead>& reads,
                             const std::filesystem::path& folder) {
  PeerFigures figures;
  figures.name = peer.name();
  ENGRAM_RETURN_IF_ERROR(make_empty(folder));
  ENGRAM_RETURN_IF_ERROR(peer.create(folder));
  ENGRAM_RETURN_IF_ERROR(write(peer, stream, figures));
  const Stopwatch clock;
  ENGRAM_RETURN_IF_ERROR(sync_tree(folder));
  figures.sync_seconds = clock.seconds();
  ENGRAM_ASSIGN_OR_RETURN(figures.disk_bytes, tree_bytes(folder));
  ENGRAM_RETURN_IF_ERROR(peer.open(folder));
  ENGRAM_RETURN_IF_ERROR(read(peer, stream, reads, figures));
  return figures;
}

}  // namespace engram::experiments
