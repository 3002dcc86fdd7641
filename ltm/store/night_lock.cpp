// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/night_lock.h"

#include "ltm/store/manifest.h"

namespace engram::ltm {

Result<NightLock> NightLock::of_learning(const std::filesystem::path& store) {
  return take(store, File::LockKind::kShared, "erases from");
}

Result<NightLock> NightLock::of_erasing(const std::filesystem::path& store) {
  return take(store, File::LockKind::kExclusive, "learns or erases from");
}

Result<NightLock> NightLock::take(const std::filesystem::path& store, File::LockKind kind,
                                  std::string_view others) {
  // Taking the lock creates its file, even in a directory that is not a store.
  ENGRAM_RETURN_IF_ERROR(read_manifest(store).status());
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(store / "NIGHT.lock", File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, file.lock(false, kind));
  if (!is_locked)
    return failed_precondition("store '{}': another process {} it: try again when it has ended",
                               store.string(), others);
  return NightLock(std::move(file));
}

}  // namespace engram::ltm
