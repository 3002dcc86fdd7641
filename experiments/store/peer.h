// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "ltm/core/buffer.h"
#include "store/bag_file.h"
#include "store/stream.h"

namespace engram::experiments {

/// A way to store a robot's stream and to find an image of it again.
///
/// Written once: prepare and append per tick, close; then read: open, image. Only append, close and
/// image are timed.
/// Errors: kUnavailable with what the library said, everywhere.
/// Threading: one thread; a peer may have threads of its own.
class Peer {
 public:
  virtual ~Peer() = default;

  [[nodiscard]] virtual std::string name() const = 0;

  /// Begins anew in an empty folder.
  virtual Status create(const std::filesystem::path& folder) = 0;

  /// Brings a tick into the form in which the peer takes it.
  virtual Status prepare(const Tick& tick) = 0;
  /// Stores what was prepared.
  virtual Status append() = 0;
  /// After this the files are whole.
  virtual Status close() = 0;

  virtual Status open(const std::filesystem::path& folder) = 0;
  /// The decoded pixels that a camera showed at exactly this time.
  virtual Result<Buffer> image(size_t camera, Time time) = 0;
};

std::unique_ptr<Peer> make_engram_peer();

std::unique_ptr<Peer> make_bag_peer(BagCompression compression);

/// WAL, a transaction per 100 ms, a blob per message: plain, or each a Zstandard frame.
std::unique_ptr<Peer> make_sqlite_peer(bool is_compressed);

}  // namespace engram::experiments
