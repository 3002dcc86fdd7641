// SPDX-License-Identifier: Apache-2.0
#include "server/access/audit_log.h"

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/core/private_file.h"
#include "ltm/core/time.h"
#include "server/access/audit_chain.h"

namespace engram::server {

namespace {

constexpr size_t kMaxTextBytes = size_t{4} << 10;
constexpr auto kSyncInterval = std::chrono::seconds(1), kRefusalInterval = std::chrono::seconds(1);

/// JSON of a text, in ASCII, so that a terminal may show it.
std::string quoted_ascii(const std::string& text) {
  std::string shown = text;
  if (text.size() > kMaxTextBytes)
    shown = fmt::format("{} ... ({} bytes, SHA-256 {})", text.substr(0, kMaxTextBytes), text.size(),
                        to_hex(hash_token(text)));
  return nlohmann::json(shown).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

std::string fields_of(const AuditEvent& event, uint64_t times) {
  std::string fields =
      fmt::format("\"time\":{},\"server\":{},\"who\":{},\"did\":{},\"on\":{}",
                  quoted_ascii(engram::to_string(system_now())), quoted_ascii(event.server),
                  quoted_ascii(event.who), quoted_ascii(event.did), quoted_ascii(event.on));
  if (!event.refused.empty()) fields += fmt::format(",\"refused\":{}", quoted_ascii(event.refused));
  if (times > 1) fields += fmt::format(",\"times\":{}", times);
  return fields;
}

}  // namespace

struct AuditLog::State {
  State(File log_file, File state_file, AuditLink where)
      : log(std::move(log_file)), state(std::move(state_file)), link(where) {}

  struct Refusals {
    SteadyTime told;      ///< When a record was written.
    uint64_t untold = 0;  ///< Refusals since then.
    AuditEvent last;
  };

  Mutex mutex;
  /// Used with the mutex held, but for sync(), which may run beside the rest.
  File log, state;
  AuditLink link ENGRAM_GUARDED_BY(mutex);
  /// Keyed by holder and what was asked: as many as a file of tokens has, times a few.
  std::map<std::pair<std::string, std::string>, Refusals> refusals ENGRAM_GUARDED_BY(mutex);
  bool is_synced ENGRAM_GUARDED_BY(mutex) = true;
  StoppableCondition wake;
  std::jthread thread;  ///< Declared last, so that it ends first.

  /// Goes on behind what a process left that was killed, or that others left.
  Status go_on() ENGRAM_REQUIRES(mutex);
  Status write(const AuditEvent& event, uint64_t times) ENGRAM_REQUIRES(mutex);
  Status keep_state() ENGRAM_REQUIRES(mutex);
  Status sync() ENGRAM_EXCLUDES(mutex);
  void run(const std::stop_token& stop) ENGRAM_EXCLUDES(mutex);
};

Status AuditLog::State::go_on() {
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, log.size());
  const std::string name = log.path().string();
  if (size < link.bytes) {
    log::warning(
        "audit log '{}': {} bytes are missing at its end: they were removed, or power was lost",
        name, link.bytes - size);
    char last = '\n';
    if (size > 0)
      ENGRAM_RETURN_IF_ERROR(log.read_at(size - 1, std::as_writable_bytes(std::span(&last, 1))));
    // What follows stays readable.
    if (last != '\n') ENGRAM_RETURN_IF_ERROR(log.append(as_bytes("\n")));
  } else if (size > link.bytes) {
    // At most one record is ahead of the state.
    std::string rest(std::min<uint64_t>(size - link.bytes, kMaxAuditLine), '\0');
    ENGRAM_RETURN_IF_ERROR(log.read_at(link.bytes, std::as_writable_bytes(std::span(rest))));
    const size_t end = rest.find('\n');
    if (end != std::string::npos && link.is_next(std::string_view(rest).substr(0, end))) {
      link.advance(std::string_view(rest).substr(0, end + 1));
    } else if (end == std::string::npos) {
      // A record that was not written whole was not acknowledged.
      log::warning("audit log '{}': {} bytes of a record that was not written whole are removed",
                   name, size - link.bytes);
      ENGRAM_RETURN_IF_ERROR(log.truncate(link.bytes));
    }
    if (const auto now = log.size(); now.ok() && *now != link.bytes)
      log::warning("audit log '{}': found {} bytes that no server wrote", name, *now - link.bytes);
  }
  ENGRAM_ASSIGN_OR_RETURN(link.bytes, log.size());
  return keep_state();
}

Status AuditLog::State::write(const AuditEvent& event, uint64_t times) {
  const std::string line = link.line_of(fields_of(event, times));
  is_synced = false;
  if (const Status status = log.append(as_bytes(line)); !status.ok()) {
    // A part of a line would hide the next one.
    if (const Status cut = log.truncate(link.bytes); !cut.ok()) log::warning("{}", cut.message());
    return status;
  }
  link.advance(line);
  return keep_state();
}

/// The new key takes the place of the old one, in the same bytes of the file.
Status AuditLog::State::keep_state() {
  return state.write_at(0, as_bytes(to_text(link)));
}

Status AuditLog::State::sync() {
  {
    const MutexLock lock(mutex);
    if (std::exchange(is_synced, true)) return {};
  }
  // Without the mutex, because a disk may take long, and requests wait for their records.
  // The log first: a state that is ahead of it would tell of records that are not there.
  ENGRAM_RETURN_IF_ERROR(log.sync());
  return state.sync();
}

void AuditLog::State::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      const MutexLock lock(mutex);
      wake.wait_for(mutex, stop, kSyncInterval, [] { return false; });
    }
    if (const Status status = sync(); !status.ok()) log::warning("audit log: {}", status.message());
  }
}

AuditLog::AuditLog(std::unique_ptr<State> state) : state_(std::move(state)) {}

std::filesystem::path AuditLog::state_path(const std::filesystem::path& path) {
  return path.string() + ".state";
}

std::filesystem::path AuditLog::key_path(const std::filesystem::path& path) {
  return path.string() + ".key";
}

AuditLog::~AuditLog() {
  state_->thread = {};
  Status status;
  {
    const MutexLock lock(state_->mutex);
    for (const auto& [kind, refusals] : state_->refusals)
      if (refusals.untold > 0 && status.ok())
        status = state_->write(refusals.last, refusals.untold);
  }
  if (status.ok()) status = state_->sync();
  if (!status.ok()) log::warning("audit log: {}", status.message());
}

Status AuditLog::create(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string secret, make_token());
  const std::vector<std::pair<std::filesystem::path, std::string>> files{
      {key_path(path), secret + "\n"},
      {state_path(path), to_text(AuditLink::first(secret))},
      {path, ""}};
  for (const auto& [file, text] : files)
    if (std::filesystem::exists(std::filesystem::symlink_status(file)))
      return already_exists("audit log: '{}' is there already", file.string());
  for (const auto& [file, text] : files) ENGRAM_RETURN_IF_ERROR(create_private_file(file, text));
  return {};
}

Result<std::unique_ptr<AuditLog>> AuditLog::open(const std::filesystem::path& path) {
  auto link = read_audit_state(state_path(path));
  if (link.status().code() == StatusCode::kNotFound)
    return not_found("audit log '{}': '{}' is not there: make it with 'engram audit create {}'",
                     path.string(), state_path(path).string(), path.string());
  ENGRAM_RETURN_IF_ERROR(link.status());
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kAppend));
  ENGRAM_ASSIGN_OR_RETURN(File state, File::open(state_path(path), File::Mode::kWrite));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_locked, state.lock(false));
  if (!is_locked)
    return failed_precondition("audit log '{}': another process adds to it", path.string());
  // Whoever held the lock until now may have gone on.
  ENGRAM_ASSIGN_OR_RETURN(link, read_audit_state(state_path(path)));
  auto opened = std::make_unique<State>(std::move(file), std::move(state), *link);
  {
    const MutexLock lock(opened->mutex);
    ENGRAM_RETURN_IF_ERROR(opened->go_on());
  }
  opened->thread =
      std::jthread([state = opened.get()](const std::stop_token& stop) { state->run(stop); });
  return std::unique_ptr<AuditLog>(new AuditLog(std::move(opened)));
}

Status AuditLog::add(const AuditEvent& event) {
  const MutexLock lock(state_->mutex);
  if (event.refused.empty()) return state_->write(event, 1);
  const SteadyTime now = steady_now();
  const auto [kind, is_new] = state_->refusals.try_emplace({event.who, event.did});
  State::Refusals& refusals = kind->second;
  ++refusals.untold;
  refusals.last = event;
  if (!is_new && now - refusals.told < kRefusalInterval) return {};
  refusals.told = now;
  return state_->write(event, std::exchange(refusals.untold, 0));
}

}  // namespace engram::server
