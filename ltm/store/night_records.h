// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/store/manifest.h"

namespace engram::ltm {

/// Where a store has the records of its nights.
inline constexpr const char* kNightsFolder = "nights";

/// What changed a store while nobody recorded: it learned, or it forgot.
enum class NightWork : uint8_t { kConsolidate, kForget };
[[nodiscard]] std::string_view to_string(NightWork work);

/// What was done to one entity. Counts are of snapshots.
struct NightEntity {
  MemoryId entity;
  std::string skipped;     ///< Why nothing was done; empty if something was.
  uint64_t learned = 0;    ///< That a model was trained on.
  uint64_t encoded = 0;    ///< That got latents.
  uint64_t waiting = 0;    ///< That wait for a later night.
  uint64_t dropped = 0;    ///< Whose recorded form went.
  uint64_t forgotten = 0;  ///< That are gone.
  uint64_t faded = 0;      ///< That have less quality than before.
  /// What the store has of it, recorded and as latents, models included. Unit: bytes.
  uint64_t bytes_before = 0;
  uint64_t bytes_after = 0;
  std::optional<double> psnr_db;      ///< Mean over the images that were encoded. Unit: dB.
  std::optional<double> min_psnr_db;  ///< That of the worst of them, or of what faded. Unit: dB.
  std::vector<int> models_added;      ///< Versions.
  std::vector<int> models_removed;
};

/// What one night did, or one run of forgetting. It holds no content and no times of snapshots.
struct NightRecord {
  NightWork work = NightWork::kConsolidate;
  Time began{};
  Time ended{};
  std::string failure;  ///< Why it ended before its time; empty if it did all that it was to do.
  uint64_t bytes_before = 0;  ///< Of all segments and models.
  uint64_t bytes_after = 0;
  std::vector<NightEntity> entities;  ///< In the order of their IDs.
};

/// The records of a store, the newest first.
struct NightRecords {
  std::vector<NightRecord> nights;
  uint64_t unreadable = 0;  ///< Files that are no such records, or damaged.
  bool has_more = false;    ///< Whether there are older ones.
};

/// Adds up what a job does to a store, and writes it into a file of the folder `nights/` of the
/// store.
/// Processes of one job write a file each; what has the same work and the same begin is one night.
///
/// All files together take at most a two-hundredth of what is published, within 32 KiB and 1 MiB;
/// the oldest go first. Threading: one thread. Source: docs/night.md, "What a night leaves behind".
class NightAccount {
 public:
  /// Looks at what the store has now.
  /// Errors: those of read_manifest.
  static Result<NightAccount> open(const std::filesystem::path& store, NightWork work, Time began);

  /// The part of one entity, for the caller to fill. Bytes and models are filled by write().
  NightEntity& of(const MemoryId& entity);

  /// Looks at what the store has then, and writes the record. `failure` may be OK. A later call
  /// writes it anew, with what came since.
  /// Errors: those of read_manifest; kUnavailable, kResourceExhausted.
  Status write(Time ended, const Status& failure = {});

 private:
  NightAccount(std::filesystem::path store, Manifest before, NightRecord record)
      : store_(std::move(store)), before_(std::move(before)), record_(std::move(record)) {}

  std::filesystem::path store_;
  Manifest before_;
  NightRecord record_;
  std::filesystem::path file_;  ///< Empty until it is written first.
};

/// Reads the newest records, at most `max` of them. A store without any has none.
/// Errors: kUnavailable if the folder cannot be listed.
Result<NightRecords> read_nights(const std::filesystem::path& store, size_t max);

}  // namespace engram::ltm
