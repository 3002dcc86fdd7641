// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string_view>
#include <system_error>

#include "datasets/recordings/folder_file.h"
#include "datasets/vault/vault_mark.h"
#include "datasets/vault/wiped_file.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"

namespace engram::datasets::vault {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUnfinished = ".new";

/// A reader may meet a key file whose old bytes are being overwritten.
constexpr int kReadAttempts = 3;

std::string name_of(const fs::path& path) {
  return printable(path.string());
}

std::optional<RandomId> id_of_name(std::string_view name) {
  RandomId id{};
  if (name.size() != 2 * id.size()) return std::nullopt;
  for (size_t i = 0; i < name.size(); ++i) {
    const char digit = name[i];
    const bool is_number = digit >= '0' && digit <= '9';
    if (!is_number && (digit < 'a' || digit > 'f')) return std::nullopt;
    const auto value = static_cast<unsigned>(is_number ? digit - '0' : digit - 'a' + 10);
    id[i / 2] |= static_cast<std::byte>(i % 2 == 0 ? value << 4U : value);
  }
  return id;
}

/// The name of a file of a day.
struct DayFileName {
  RandomId id{};
  bool is_unfinished = false;
};

std::optional<DayFileName> parsed(std::string_view name) {
  const bool is_unfinished = name.ends_with(kUnfinished);
  if (is_unfinished) name.remove_suffix(kUnfinished.size());
  const auto id = id_of_name(name);
  if (!id) return std::nullopt;
  return DayFileName{*id, is_unfinished};
}

/// Both paths without links, since the key file is replaced and a link to it must not be.
Result<VaultPlaces> resolved(const VaultPlaces& places) {
  std::error_code error;
  VaultPlaces real{fs::weakly_canonical(fs::absolute(places.vault, error), error), {}};
  if (!error) real.keys = fs::weakly_canonical(fs::absolute(places.keys, error), error);
  if (error)
    return unavailable("'{}', '{}': {}", name_of(places.vault), name_of(places.keys),
                       error.message());
  if (!real.vault.has_filename()) real.vault = real.vault.parent_path();
  if (is_inside(real.vault, real.keys))
    return failed_precondition(
        "key file '{}': lies inside the vault '{}', needs a place outside: who gets the vault "
        "would "
        "get its keys",
        name_of(places.keys), name_of(places.vault));
  return real;
}

/// Forces all that was written below a directory to the disk at once, since a vault may get
/// thousands of small files.
Status sync_file_system(const fs::path& directory) {
  const int fd = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool is_done = fd >= 0 && ::syncfs(fd) == 0;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  if (is_done) return {};
  const std::string message = fmt::format("'{}': cannot force to disk: {}", name_of(directory),
                                          std::generic_category().message(error));
  return error == ENOSPC ? Status(StatusCode::kResourceExhausted, message)
                         : Status(StatusCode::kUnavailable, message);
}

fs::path unfinished_file(const fs::path& vault, const RandomId& file) {
  return vault / (to_text(file) + std::string(kUnfinished));
}

/// A killed process may have left the file that was to name the vault.
Result<bool> has_no_file(const fs::path& vault) {
  std::error_code error;
  for (fs::directory_iterator entry(vault, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto name = parsed(entry->path().filename().string());
    if (!name || !name->is_unfinished) return false;
  }
  if (error) return unavailable("'{}': {}", name_of(vault), error.message());
  return true;
}

Status check_same_vault(const VaultPlaces& places, const RandomId& found, const VaultKeys& keys) {
  if (found == keys.vault) return {};
  return failed_precondition("key file '{}': is of vault {}, '{}' is vault {}",
                             name_of(places.keys), to_text(keys.vault), name_of(places.vault),
                             to_text(found));
}

/// The places of keys to be destroyed. Who holds the vault decides what its path leads to, so that
/// counts for nothing here.
Result<VaultPlaces> resolved_keys(const VaultPlaces& places) {
  std::error_code error;
  VaultPlaces real{fs::absolute(places.vault, error).lexically_normal(), {}};
  real.keys = fs::weakly_canonical(fs::absolute(places.keys, error), error);
  if (error) return unavailable("'{}': {}", name_of(places.keys), error.message());
  if (!real.vault.has_filename()) real.vault = real.vault.parent_path();
  return real;
}

/// True if the directory has a file of which there is a key.
bool has_any_file(const fs::path& vault, const VaultKeys& keys) {
  std::error_code error;
  for (const auto& [entity, days] : keys.days)
    for (const auto& [day, kept] : days)
      if (fs::exists(day_file(vault, kept.file), error)) return true;
  return false;
}

}  // namespace

fs::path day_file(const fs::path& vault, const RandomId& file) {
  std::error_code error;
  const fs::path whole = vault / to_text(file), unfinished = unfinished_file(vault, file);
  return !fs::exists(whole, error) && fs::exists(unfinished, error) ? unfinished : whole;
}

Result<VaultKeys> read_keys(const fs::path& keys) {
  for (int attempt = 1;; ++attempt) {
    ENGRAM_ASSIGN_OR_RETURN(const SecretBytes bytes, read_secret_file(keys));
    auto found = decode_keys(bytes);
    if (found.ok()) return found;
    if (attempt == kReadAttempts || found.status().code() != StatusCode::kDataLoss)
      return found.status().with_context(fmt::format("key file '{}'", name_of(keys)));
  }
}

Result<VaultKeys> read_keys_of(const VaultPlaces& places) {
  ENGRAM_ASSIGN_OR_RETURN(const VaultPlaces real, resolved(places));
  const auto id = read_vault_id(real.vault);
  const bool is_damaged = id.status().code() == StatusCode::kDataLoss;
  if (!id.ok() && !is_damaged) return id.status();
  ENGRAM_ASSIGN_OR_RETURN(VaultKeys keys, read_keys(real.keys));
  // The file that names the vault holds nothing else: the others are read without it.
  if (is_damaged && !has_any_file(real.vault, keys)) return id.status();
  if (is_damaged)
    log::warning("{}; the next export writes it anew", id.status().message());
  else
    ENGRAM_RETURN_IF_ERROR(check_same_vault(places, *id, keys));
  return keys;
}

Result<VaultFiles> list_files(const fs::path& vault) {
  VaultFiles files;
  std::error_code error;
  for (fs::directory_iterator entry(vault, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto name = parsed(entry->path().filename().string());
    if (name) (name->is_unfinished ? files.unfinished : files.whole).push_back(name->id);
  }
  if (error) return unavailable("vault '{}': {}", name_of(vault), error.message());
  return files;
}

Result<VaultFolder> VaultFolder::lock(const VaultPlaces& real) {
  fs::path name = real.keys;
  name += ".lock";
  ENGRAM_ASSIGN_OR_RETURN(File lock, File::open(name, File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, lock.lock(false));
  if (!is_locked)
    return failed_precondition("key file '{}': another process is changing it", name_of(real.keys));
  // Not only at the end of hours of work.
  ENGRAM_RETURN_IF_ERROR(check_replaceable(real.keys));
  return VaultFolder(real, std::move(lock));
}

Result<VaultFolder> VaultFolder::open(const VaultPlaces& places) {
  ENGRAM_ASSIGN_OR_RETURN(const VaultPlaces real, resolved(places));
  ENGRAM_ASSIGN_OR_RETURN(VaultFolder folder, lock(real));
  ENGRAM_RETURN_IF_ERROR(folder.make_or_read_keys());
  ENGRAM_RETURN_IF_ERROR(folder.make_or_check_vault());
  ENGRAM_RETURN_IF_ERROR(folder.clean());
  return folder;
}

Result<VaultFolder> VaultFolder::open_keys(const VaultPlaces& places) {
  ENGRAM_ASSIGN_OR_RETURN(const VaultPlaces real, resolved_keys(places));
  ENGRAM_ASSIGN_OR_RETURN(VaultFolder folder, lock(real));
  ENGRAM_RETURN_IF_ERROR(wipe_leftovers(real.keys));
  ENGRAM_ASSIGN_OR_RETURN(folder.keys_, read_keys(real.keys));
  const auto id = read_vault_id(real.vault);
  // These are likely the wrong keys. Nothing else about the vault may stop their destruction.
  if (id.ok() && *id != folder.keys_.vault)
    return check_same_vault(places, *id, folder.keys_)
        .with_context("to destroy these keys all the same, name a place without a vault");
  const bool is_damaged = id.status().code() == StatusCode::kDataLoss;
  folder.is_within_reach_ = id.ok() || (is_damaged && has_any_file(real.vault, folder.keys_));
  if (!folder.is_within_reach_ && id.status().code() != StatusCode::kNotFound)
    folder.lose_reach(id.status());
  if (!folder.is_within_reach_) return folder;
  auto locked = lock_vault_mark(real.vault);
  if (locked.ok())
    folder.lock_of_mark_ = *std::move(locked);
  else
    folder.lose_reach(locked.status());
  return folder;
}

VaultFolder::VaultFolder(VaultFolder&&) noexcept = default;

VaultFolder::~VaultFolder() {
  for (const RandomId& file : waiting_)
    if (const Status removed = remove_file(new_file(file)); !removed.ok())
      log::warning("a file is left over, which the next export removes: {}", removed.to_string());
}

Status VaultFolder::make_or_read_keys() {
  ENGRAM_RETURN_IF_ERROR(wipe_leftovers(places_.keys));
  auto found = read_keys(places_.keys);
  if (found.ok()) {
    keys_ = *std::move(found);
    return {};
  }
  if (found.status().code() != StatusCode::kNotFound) return found.status();
  const auto id = read_vault_id(places_.vault);
  if (!id.ok() && id.status().code() != StatusCode::kNotFound) return id.status();
  if (id.ok())
    return failed_precondition(
        "vault '{}': is there already, but not the key file '{}'; needs the one that it was made "
        "with, or another place for a new vault",
        name_of(places_.vault), name_of(places_.keys));
  ENGRAM_RETURN_IF_ERROR(fill_random(keys_.vault));
  return save();
}

Status VaultFolder::make_or_check_vault() {
  is_within_reach_ = true;
  // Before it may be written anew, and then the new one: neither is anybody else's.
  ENGRAM_ASSIGN_OR_RETURN(lock_of_mark_, lock_vault_mark(places_.vault));
  const auto id = read_vault_id(places_.vault);
  if (id.ok()) return check_same_vault(places_, *id, keys_);
  const StatusCode why = id.status().code();
  if (why != StatusCode::kNotFound && why != StatusCode::kDataLoss) return id.status();
  if (has_any_file(places_.vault, keys_)) return make_mark(why == StatusCode::kDataLoss);
  if (why == StatusCode::kDataLoss) return id.status();
  if (keys_.day_count() + keys_.destroyed_count() > 0)
    return failed_precondition(
        "vault '{}': is not there, but its key file '{}' has keys of {} entity-days; is its disk "
        "mounted?",
        name_of(places_.vault), name_of(places_.keys), keys_.day_count());
  std::error_code error;
  const bool is_there = fs::exists(places_.vault, error);
  ENGRAM_RETURN_IF_ERROR(make_directories(places_.vault));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_empty, has_no_file(places_.vault));
  if (!is_empty)
    return already_exists("'{}': has other files, needs an empty directory or a new one",
                          name_of(places_.vault));
  // Whoever made the directory decided who may fetch the vault, say a backup of another user. File
  // systems without permissions do without.
  if (!is_there) fs::permissions(places_.vault, fs::perms::owner_all, error);
  return make_mark(false);
}

Status VaultFolder::make_mark(bool replaces_damaged) {
  RandomId name{};
  ENGRAM_RETURN_IF_ERROR(fill_random(name));
  ENGRAM_ASSIGN_OR_RETURN(lock_of_new_mark_, make_vault_mark(places_.vault, keys_.vault,
                                                             new_file(name), replaces_damaged));
  return {};
}

/// Ends what a killed process began.
Status VaultFolder::clean() {
  ENGRAM_ASSIGN_OR_RETURN(const VaultFiles files, list_files(places_.vault));
  std::set<RandomId> live, gone = keys_.obsolete;
  for (const auto& [entity, days] : keys_.days)
    for (const auto& [day, kept] : days) live.insert(kept.file);
  for (const auto& [entity, days] : keys_.destroyed)
    for (const auto& [day, destroyed] : days) gone.insert(destroyed.file);
  for (const RandomId& file : files.unfinished)
    ENGRAM_RETURN_IF_ERROR(live.contains(file)
                               ? publish_file(new_file(file), places_.vault / to_text(file))
                               : remove_file(new_file(file)));
  // A whole file without a key is left alone: an older copy of the key file does not know newer
  // ones.
  for (const RandomId& file : files.whole)
    if (gone.contains(file)) ENGRAM_RETURN_IF_ERROR(remove_file_of(file));
  keys_.obsolete.clear();
  return {};
}

fs::path VaultFolder::new_file(const RandomId& file) const {
  return unfinished_file(places_.vault, file);
}

void VaultFolder::put(const ltm::MemoryId& entity, Day day, const VaultDay& made) {
  const auto [place, is_new] = keys_.days[entity].try_emplace(day, made);
  if (!is_new) {
    keys_.obsolete.insert(place->second.file);
    place->second = made;
  }
  waiting_.push_back(made.file);
  waiting_bytes_ += made.file_bytes;
  has_changes_ = true;
}

void VaultFolder::keep(const ltm::MemoryId& entity, Day day, uint64_t source, uint64_t times) {
  VaultDay& kept = keys_.days.at(entity).at(day);
  kept.source = source;
  kept.times = times;
  has_changes_ = true;
}

void VaultFolder::describe(const std::string& store_id, ltm::SegmentTypes types) {
  if (keys_.store_id == store_id && keys_.types == types) return;
  keys_.store_id = store_id;
  keys_.types = std::move(types);
  has_changes_ = true;
}

Status VaultFolder::commit() {
  if (!has_changes_) return {};
  if (!waiting_.empty()) ENGRAM_RETURN_IF_ERROR(sync_file_system(places_.vault));
  // Whatever becomes of it, the next process looks into the key file for which of them count.
  const std::vector<RandomId> made = std::exchange(waiting_, {});
  waiting_bytes_ = 0;
  ENGRAM_RETURN_IF_ERROR(save());
  has_changes_ = false;
  std::error_code error;
  for (const RandomId& file : made) {
    fs::rename(new_file(file), places_.vault / to_text(file), error);
    if (error)
      return unavailable("'{}': cannot rename: {}", name_of(new_file(file)), error.message());
  }
  if (!made.empty()) ENGRAM_RETURN_IF_ERROR(sync_directory(places_.vault));
  for (const RandomId& file : keys_.obsolete) ENGRAM_RETURN_IF_ERROR(remove_file_of(file));
  keys_.obsolete.clear();
  return {};
}

Status VaultFolder::destroy(const std::vector<EntityDay>& days, Time now) {
  for (const auto& [entity, day] : days) {
    const auto of_entity = keys_.days.find(entity);
    if (of_entity == keys_.days.end()) continue;
    const auto kept = of_entity->second.find(day);
    if (kept == of_entity->second.end()) continue;
    keys_.destroyed[entity][day] = {kept->second.file, now};
    of_entity->second.erase(kept);
    if (of_entity->second.empty()) keys_.days.erase(of_entity);
  }
  std::vector<ltm::MemoryId> entities;
  for (const auto& [entity, of_entity] : keys_.days) entities.push_back(entity);
  keys_.types = keys_.types.of_entities(entities);
  // The keys go first: without them the files are noise, whoever holds them.
  ENGRAM_RETURN_IF_ERROR(save());
  if (!is_within_reach_) return {};
  Status removed = clean();
  if (removed.ok()) removed = sync_directory(places_.vault);
  if (!removed.ok()) lose_reach(removed);
  return {};
}

void VaultFolder::lose_reach(const Status& why) {
  is_within_reach_ = false;
  log::warning(
      "vault '{}': files of days whose keys are destroyed stay there until an export removes them: "
      "{}",
      name_of(places_.vault), why.message());
}

Status VaultFolder::save() {
  ENGRAM_ASSIGN_OR_RETURN(const SecretBytes bytes, encode_keys(keys_));
  return replace_secret_file(places_.keys, bytes);
}

Status VaultFolder::remove_file_of(const RandomId& file) const {
  ENGRAM_RETURN_IF_ERROR(remove_file(new_file(file)));
  return remove_file(places_.vault / to_text(file));
}

}  // namespace engram::datasets::vault
