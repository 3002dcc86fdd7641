// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "ltm/codec/packed_value.h"
#include "ltm/filter/filter.h"
#include "ltm/memory/commit.h"
#include "ltm/store/store_writer.h"

namespace engram::ltm {

/// What happened to the snapshots of one entity on their way in.
struct RecordingCounters {
  uint64_t offered = 0;
  uint64_t offered_bytes = 0;  ///< Plain bytes.
  uint64_t kept = 0;
  uint64_t kept_bytes = 0;    ///< Plain bytes.
  uint64_t stored_bytes = 0;  ///< Of the journal frames.
  std::map<std::string, uint64_t, std::less<>> dropped_by;  ///< Per filter name.
  /// Instances that were cast to their segment's type, which cost members or digits.
  uint64_t reinterpreted = 0;
  std::string last_reinterpretation;  ///< What it cost, the last time.
};

/// The online phase: filters what comes in, encodes what is kept, stores it.
///
/// Threading: one thread.
/// Source: docs/design.md, section 1.
class Recorder {
 public:
  struct Options {
    /// Most snapshots per second and entity that are kept. Nothing: all.
    std::optional<double> max_rate_hz;
    PackOptions pack;
    StoreWriter::Options store;

    [[nodiscard]] Status validate() const;
  };

  /// Opens `store` for writing and makes it where it does not exist.
  /// Errors: kInvalidArgument, kFailedPrecondition where another process writes to it, and those
  /// of StoreWriter::open.
  static Result<Recorder> open(const std::filesystem::path& store, const Options& options);

  Recorder(Recorder&&) noexcept;
  ~Recorder();

  /// Says what the values of a core segment (two names) or provider segment (three) are: commits
  /// are reinterpreted as that type where possible, and refused where not. The type is stored with
  /// the segment and holds in later sessions too.
  /// Errors: kInvalidArgument where a provider's type does not extend the core type; those of
  /// StoreWriter::declare.
  Status declare(const MemoryId& segment, const idf::Type& type);

  /// After this returns ok, every kept snapshot of the commit survives `kill -9`.
  /// Errors: those of Commit::check; kInvalidArgument where a time does not come after the
  /// entity's last one, or naming every path where a value is not of its segment's type;
  /// kResourceExhausted, kUnavailable where the disk fails: then nothing was acknowledged.
  Status commit(const Commit& commit);

  /// Seals everything and closes the store. Without it the journal keeps it all.
  Status close();

  /// Time of the entity's last snapshot, stored in this session or before.
  [[nodiscard]] std::optional<Time> last_time(const MemoryId& entity) const;

  /// Places in the journal where acknowledged data of an earlier session was found damaged.
  [[nodiscard]] uint64_t lost_frames() const;

  /// Per entity of this session.
  [[nodiscard]] const std::map<MemoryId, RecordingCounters>& counters() const;

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
