// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_check.h"

#include <set>

#include "datasets/vault/day_records.h"
#include "datasets/vault/vault_mark.h"
#include "datasets/vault/work_progress.h"
#include "ltm/core/printable.h"

namespace engram::datasets::vault {

namespace {

class VaultCheck {
 public:
  VaultCheck(std::filesystem::path vault, const ProgressSink& progress, const std::stop_token& stop)
      : vault_(std::move(vault)), stop_(stop), progress_("verify vault", progress) {}

  Result<VaultCheckReport> without_keys() {
    ENGRAM_RETURN_IF_ERROR(read_vault_id(vault_).status());
    ENGRAM_ASSIGN_OR_RETURN(const VaultFiles files, list_files(vault_));
    progress_.begin(files.whole.size());
    for (const RandomId& file : files.whole) {
      if (stop_.stop_requested()) return cancelled("verifying was stopped");
      const auto path = vault_ / to_text(file);
      count(path);
      if (const Status status = check_sealed_file(path, file); !status.ok())
        report_.damaged.push_back({{}, 0, to_text(file), status.message()});
      progress_.add(1, "");
    }
    progress_.end();
    return std::move(report_);
  }

  Result<VaultCheckReport> with_keys(const VaultKeys& keys) {
    report_.had_keys = true;
    report_.destroyed = keys.destroyed_count();
    if (const auto id = read_vault_id(vault_); !id.ok())
      report_.damaged.push_back({{}, 0, "engram.vault", id.status().message()});
    ENGRAM_RETURN_IF_ERROR(count_others(keys));
    uint64_t total = 0;
    for (const auto& [entity, days] : keys.days)
      for (const auto& [day, kept] : days) total += kept.snapshots;
    progress_.begin(total);
    for (const auto& [entity, days] : keys.days)
      for (const auto& [day, kept] : days) {
        const Status status = check(entity, day, kept);
        if (status.code() == StatusCode::kCancelled) return status;
        if (!status.ok())
          report_.damaged.push_back({entity, day, to_text(kept.file), status.message()});
      }
    progress_.end();
    return std::move(report_);
  }

 private:
  Status count_others(const VaultKeys& keys) {
    ENGRAM_ASSIGN_OR_RETURN(const VaultFiles files, list_files(vault_));
    std::set<RandomId> live, gone = keys.obsolete;
    for (const auto& [entity, days] : keys.days)
      for (const auto& [day, kept] : days) live.insert(kept.file);
    for (const auto& [entity, days] : keys.destroyed)
      for (const auto& [day, destroyed] : days) gone.insert(destroyed.file);
    for (const RandomId& file : files.whole) {
      report_.remains += gone.contains(file) ? 1 : 0;
      report_.without_key += !gone.contains(file) && !live.contains(file) ? 1 : 0;
    }
    return {};
  }

  Status check(const ltm::MemoryId& entity, Day day, const VaultDay& kept) {
    const auto path = day_file(vault_, kept.file);
    count(path);
    ENGRAM_ASSIGN_OR_RETURN(DayReader reader, DayReader::open(path, entity, day, kept));
    const std::string name = printable_day(entity, day);
    uint64_t found = 0;
    while (true) {
      if (stop_.stop_requested()) return cancelled("verifying was stopped");
      ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader.next());
      if (!snapshot) break;
      ++found;
      ++report_.snapshots;
      progress_.add(1, name);
    }
    if (found == kept.snapshots) return {};
    return data_loss("'{}': has {} snapshots, the key file says {}", printable(path.string()),
                     found, kept.snapshots);
  }

  void count(const std::filesystem::path& path) {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(path, error);
    ++report_.files;
    report_.bytes += error ? 0 : bytes;
  }

  std::filesystem::path vault_;
  const std::stop_token& stop_;
  WorkProgress progress_;
  VaultCheckReport report_;
};

}  // namespace

Result<VaultCheckReport> check_vault(const VaultPlaces& places, const ProgressSink& progress,
                                     const std::stop_token& stop) {
  VaultCheck check(places.vault, progress, stop);
  if (places.keys.empty()) return check.without_keys();
  ENGRAM_ASSIGN_OR_RETURN(const VaultKeys keys, read_keys_of(places));
  return check.with_keys(keys);
}

}  // namespace engram::datasets::vault
