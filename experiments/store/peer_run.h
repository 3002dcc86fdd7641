// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "store/image_reads.h"
#include "store/peer.h"
#include "store/store_measure.h"

namespace engram::experiments {

/// The measurements of one peer.
struct PeerFigures {
  std::string name;
  uint64_t disk_bytes = 0;
  double write_seconds = 0;      ///< Until closed, without the time to make messages.
  double write_cpu_seconds = 0;  ///< CPU time of all threads for the same; zero if unknown.
  double sync_seconds = 0;       ///< Further time to force all files to the disk.
  Latency read;                  ///< To read one image with files in the cache.
};

/// Writes the stream, closes, opens again and reads. Every image is compared with the stream.
/// Errors: those of the peer; kDataLoss naming the image that differs.
Result<PeerFigures> run_peer(Peer& peer, const Stream& stream, const std::vector<ImageRead>& reads,
                             const std::filesystem::path& folder);

/// Does the same in Python, with one dataset per sensor, gzip and a chunk per image.
/// Errors: kUnavailable if the script fails.
Result<PeerFigures> run_h5py(const Stream& stream, const std::vector<ImageRead>& reads,
                             const std::filesystem::path& folder);

}  // namespace engram::experiments
