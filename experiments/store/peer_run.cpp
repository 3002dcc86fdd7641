// SPDX-License-Identifier: Apache-2.0
#include "store/peer_run.h"

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

Status read(Peer& peer, const Stream& stream, const std::vector<ImageRead>& reads,
            PeerFigures& figures) {
  std::vector<double> latencies;
  for (const ImageRead& it : reads) {
    const Time time = stream.tick(it.tick).time;
    const Stopwatch clock;
    ENGRAM_ASSIGN_OR_RETURN(const Buffer found, peer.image(it.camera, time));
    latencies.push_back(clock.seconds());
    const Status is_exact = expect_image(found, stream, it);
    if (!is_exact.ok()) return is_exact.with_context(figures.name);
  }
  figures.read = summarize(latencies);
  return {};
}

}  // namespace

Result<PeerFigures> run_peer(Peer& peer, const Stream& stream, const std::vector<ImageRead>& reads,
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
