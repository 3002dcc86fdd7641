// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "store/image_reads.h"
#include "store/peer.h"
#include "store/store_measure.h"

namespace engram::experiments {

/// What came of one peer.
struct PeerFigures {
  std::string name;
  uint64_t disk_bytes = 0;
  double write_seconds = 0;      ///< Until closed, without the making of messages.
  double write_cpu_seconds = 0;  ///< The same of all threads; zero where unknown.
  double sync_seconds = 0;       ///< What it took after that to force all files to the disk.
  Latency read;                  ///< Of one image, files in the cache.
};

/// Writes the stream, closes, opens anew and reads; every image is compared with the stream.
/// Errors: those of the peer; kDataLoss naming the image that came back otherwise.
Result<PeerFigures> run_peer(Peer& peer, const Stream& stream, const std::vector<ImageRead>& reads,
                             const std::filesystem::path& folder);

/// The same in Python: one dataset per sensor, gzip, a chunk per image.
/// Errors: kUnavailable where the script fails.
Result<PeerFigures> run_h5py(const Stream& stream, const std::vector<ImageRead>& reads,
                             const std::filesystem::path& folder);

}  // namespace engram::experiments
