// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/access_log.h"

#include <unistd.h>

#include <algorithm>
#include <set>
#include <string>

#include "ltm/core/log.h"
#include "ltm/idf/binary.h"
#include "ltm/store/journal.h"

namespace engram::ltm {

namespace {

constexpr const char* kFolder = "access";
constexpr const char* kSummary = "summary.log";
constexpr const char* kLock = "merge.lock";

/// Above either limit the logs are merged.
constexpr size_t kMaxFiles = 64;
constexpr uint64_t kMaxUnmergedBytes = uint64_t{4} << 20;

/// A larger file was not written by this code and is not read.
constexpr uint64_t kMaxFileBytes = uint64_t{256} << 20;

/// What was read from files, and the names of the logs that a summary already contains.
struct Notes {
  AccessTable table;
  std::set<std::string> merged;
};

std::vector<std::byte> must_encode(const idf::Data& value) {
  auto bytes = idf::encode(value);
  ENGRAM_CHECK(bytes.ok(), "{}", bytes.status().to_string());
  return *std::move(bytes);
}

/// Encodes one frame per entity.
std::vector<std::vector<std::byte>> encode(const AccessTable& table) {
  std::vector<std::vector<std::byte>> frames;
  for (const auto& [entity, snapshots] : table.all()) {
    std::vector<int64_t> times, counts, last;
    for (const auto& [time, stats] : snapshots) {
      times.push_back(to_ns(time));
      counts.push_back(static_cast<int64_t>(stats.count));
      last.push_back(to_ns(stats.last));
    }
    const auto size = static_cast<int64_t>(times.size());
    frames.push_back(
        must_encode(idf::Dict{{"entity", entity.to_string()},
                              {"snapshots", idf::NdArray::take({size}, std::move(times))},
                              {"counts", idf::NdArray::take({size}, std::move(counts))},
                              {"last", idf::NdArray::take({size}, std::move(last))}}));
  }
  return frames;
}

/// The int64 array [n] at a key; empty if the value there is something else.
std::optional<std::span<const int64_t>> numbers(const idf::Data& value, std::string_view key) {
  const idf::Data* part = value.at(key);
  const auto* array = part == nullptr ? nullptr : part->get_if<idf::NdArray>();
  if (array == nullptr || array->type() != idf::ElementType::kInt64 || array->shape().size() != 1)
    return std::nullopt;
  return array->values<int64_t>();
}

/// Adds one frame to `notes`. A malformed frame is ignored as a whole.
void add_frame(const idf::Data& value, Notes& notes) {
  if (const idf::Data* merged = value.at("merged")) {
    if (const auto* names = merged->get_if<idf::List>())
      for (const idf::Data& name : *names)
        if (const auto* text = name.get_if<std::string>()) notes.merged.insert(*text);
    return;
  }
  const idf::Data* name = value.at("entity");
  const auto* text = name == nullptr ? nullptr : name->get_if<std::string>();
  const auto entity = MemoryId::parse(text == nullptr ? "" : *text);
  const auto times = numbers(value, "snapshots");
  const auto counts = numbers(value, "counts");
  const auto last = numbers(value, "last");
  if (!entity.ok() || !entity->is_entity() || !times || !counts || !last ||
      counts->size() != times->size() || last->size() != times->size())
    return;
  for (size_t i = 0; i < times->size(); ++i)
    if ((*counts)[i] > 0)
      notes.table.add(*entity, time_from_ns((*times)[i]), static_cast<uint64_t>((*counts)[i]),
                      time_from_ns((*last)[i]));
}

/// Adds the whole frames of a file. The rest is damaged or was left by a killed reader, and losing
/// it is not worth an error: notes only guide forgetting.
void add_file(const std::filesystem::path& file, Notes& notes) {
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(file, error);
  if (error || bytes > kMaxFileBytes) return;
  const auto scanned = scan_journal(file, [&notes](uint64_t, const Buffer& payload) -> Status {
    if (const auto value = idf::decode(payload); value.ok()) add_frame(*value, notes);
    return {};
  });
  if (!scanned.ok()) log::debug("accesses '{}': {}", file.string(), scanned.status().to_string());
}

struct Files {
  std::vector<std::filesystem::path> logs;  ///< Sorted by name.
  uint64_t bytes = 0;                       ///< Of the logs and the summary.
  uint64_t log_bytes = 0;                   ///< Of the logs.
};

Files list_files(const std::filesystem::path& store) {
  Files files;
  std::error_code error;
  std::filesystem::directory_iterator entry(store / kFolder, error);
  for (; !error && entry != std::filesystem::end(entry); entry.increment(error)) {
    std::error_code gone;
    const uint64_t bytes = entry->file_size(gone);
    if (gone || entry->path().extension() != ".log") continue;
    files.bytes += bytes;
    if (entry->path().filename() == kSummary) continue;
    files.log_bytes += bytes;
    files.logs.push_back(entry->path());
  }
  std::ranges::sort(files.logs);
  return files;
}

bool has_notes(const std::filesystem::path& store) {
  return list_files(store).bytes > 0;
}

/// Writes a summary that contains `table` and names the logs that are merged into it. The names
/// keep a log from being counted twice if a kill comes before the log is removed.
Status write_summary(const std::filesystem::path& store, const AccessTable& table,
                     const std::vector<std::filesystem::path>& logs) {
  idf::List names;
  for (const auto& log : logs) names.emplace_back(log.filename().string());
  auto payloads = encode(table);
  payloads.push_back(must_encode(idf::Dict{{"merged", std::move(names)}}));
  ENGRAM_ASSIGN_OR_RETURN(const auto frames, encode_journal_frames(payloads));
  std::vector<std::byte> file(as_bytes(kJournalMagic).begin(), as_bytes(kJournalMagic).end());
  file.insert(file.end(), frames.begin(), frames.end());
  return replace_file(store / kFolder / kSummary, file);
}

}  // namespace

AccessLog::AccessLog(std::filesystem::path store, const Options& options, Clock clock)
    : store_(std::move(store)), options_(options), clock_(std::move(clock)) {}

AccessLog::~AccessLog() {
  flush();
}

void AccessLog::note(const MemoryId& entity, Time snapshot) {
  const Time now = clock_();
  if (reads_++ == 0) first_ = now;
  noted_.add(entity, snapshot, 1, now);
  if (reads_ >= options_.batch || now - first_ >= options_.interval) flush();
}

void AccessLog::flush() {
  if (noted_.empty()) return;
  // A store may be read-only. That is no fault, so there is no warning.
  if (const Status status = write(); !status.ok())
    log::debug("store '{}': accesses are not kept: {}", store_.string(), status.to_string());
  noted_.clear();
  reads_ = 0;
}

Status AccessLog::write() {
  if (!file_) ENGRAM_RETURN_IF_ERROR(open_file());
  ENGRAM_ASSIGN_OR_RETURN(const auto frames, encode_journal_frames(encode(noted_)));
  // Readers stop at a torn frame, so after a failed append the next frames go to another file.
  Status status = file_->append(frames);
  const auto size = file_->size();
  if (!status.ok() || !size.ok() || *size >= options_.file_bytes) file_.reset();
  return status;
}

Status AccessLog::open_file() {
  const Files there = list_files(store_);
  if (there.bytes >= options_.max_bytes || there.logs.size() >= options_.max_files)
    return resource_exhausted("'{}': holds too many notes", (store_ / kFolder).string());
  ENGRAM_RETURN_IF_ERROR(make_directories(store_ / kFolder));
  // Process IDs are reused. The time makes the name one that no summary has named before.
  const std::string name = fmt::format("{}-{}.log", ::getpid(), to_ns(system_now()));
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(store_ / kFolder / name, File::Mode::kCreate));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, file.lock(false));
  if (!is_locked) return unavailable("'{}': is being merged", name);
  ENGRAM_RETURN_IF_ERROR(file.append(as_bytes(kJournalMagic)));
  file_ = std::move(file);
  return {};
}

AccessTable read_accesses(const std::filesystem::path& store) {
  // The summary is read last: it contains any log that a merge removed in the meantime.
  std::map<std::string, Notes> logs;
  for (const auto& log : list_files(store).logs) add_file(log, logs[log.filename().string()]);
  Notes sum;
  add_file(store / kFolder / kSummary, sum);
  for (const auto& [name, notes] : logs)
    if (!sum.merged.contains(name)) sum.table.add(notes.table);
  return std::move(sum.table);
}

Status merge_accesses(const std::filesystem::path& store, const std::map<MemoryId, TimeSet>& gone) {
  if (!has_notes(store)) return {};
  ENGRAM_ASSIGN_OR_RETURN(File lock, File::open(store / kFolder / kLock, File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_ours, lock.lock(false));
  if (!is_ours) return {};
  Notes sum;
  add_file(store / kFolder / kSummary, sum);
  std::vector<std::filesystem::path> taken;
  std::vector<File> held;  // The locks show that the readers have ended, and keep others out.
  for (const auto& log : list_files(store).logs) {
    auto file = File::open(log, File::Mode::kRead);
    if (!file.ok()) continue;
    const auto is_free = file->lock(false);
    if (!is_free.ok() || !*is_free) continue;
    if (!sum.merged.contains(log.filename().string())) add_file(log, sum);
    taken.push_back(log);
    held.push_back(*std::move(file));
  }
  for (const auto& [entity, times] : gone)
    for (const Time time : times) sum.table.erase(entity, time);
  ENGRAM_RETURN_IF_ERROR(write_summary(store, sum.table, taken));
  for (const auto& log : taken) ENGRAM_RETURN_IF_ERROR(remove_file(log));
  return {};
}

Status merge_grown_accesses(const std::filesystem::path& store) {
  const Files files = list_files(store);
  const bool has_grown = files.logs.size() > kMaxFiles || files.log_bytes > kMaxUnmergedBytes;
  return has_grown ? merge_accesses(store) : Status();
}

}  // namespace engram::ltm
