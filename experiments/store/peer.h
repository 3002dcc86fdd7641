// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "ltm/core/buffer.h"
#include "store/bag_file.h"
#include "store/stream.h"

namespace engram::experiments {

/// A way to store a robot's stream and to read an image of it.
///
/// It is written once, with prepare and append per tick and a final close, and then read with open
/// and image. Only append, close and image are timed.
/// Errors: every function returns kUnavailable with the message of the library.
/// Threading: one thread; a peer may have threads of its own.
class Peer {
 public:
  virtual ~Peer() = default;

  [[nodiscard]] virtual std::string name() const = 0;

  /// Starts a new store in an empty folder.
  virtual Status create(const std::filesystem::path& folder) = 0;

  /// Converts a tick to the form that the peer stores.
  virtual Status prepare(const Tick& tick) = 0;
  /// Stores the tick that was prepared.
  virtual Status append() = 0;
  /// Completes the files.
  virtual Status close() = 0;

  virtual Status open(const std::filesystem::path& folder) = 0;
  /// Returns the decoded pixels that a camera showed at exactly this time.
  virtual Result<Buffer> image(size_t camera, Time time) = 0;
};

std::unique_ptr<Peer> make_engram_peer();

std::unique_ptr<Peer> make_bag_peer(BagCompression compression);

/// Uses WAL, a transaction per 100 ms and a blob per message, which is plain or a Zstandard frame.
std::unique_ptr<Peer> make_sqlite_peer(bool is_compressed);

}  // namespace engram::experiments
