// SPDX-License-Identifier: Apache-2.0
#include "server/access/audit_check.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string_view>

#include "ltm/core/buffer.h"
#include "ltm/core/file.h"
#include "ltm/core/private_file.h"
#include "server/access/audit_chain.h"
#include "server/access/audit_log.h"

namespace engram::server {

namespace {

constexpr size_t kMaxKeyBytes = 1024, kChunkBytes = size_t{1} << 20;
/// How far behind the state a record may be, or behind the last one where there is no state.
constexpr uint64_t kMaxAhead = 1000, kMaxGap = 1'000'000;
/// Keys that are made to look for records behind gaps, so that hostile logs come to an end, too.
constexpr uint64_t kMaxSkips = 20'000'000;

std::string records_text(uint64_t first, uint64_t end) {
  return end - first == 1 ? fmt::format("record {} is missing", first)
                          : fmt::format("records {} to {} are missing", first, end - 1);
}

class AuditVerifier {
 public:
  AuditVerifier(AuditLink first, std::optional<AuditLink> state, std::stop_token stop)
      : next_(first), state_(std::move(state)), stop_(std::move(stop)) {}

  void add_line(std::string_view line) {
    ++report_.lines;
    const auto told = parse_audit_line(line);
    if (!told) {
      add_flaw("is no record");
      return;
    }
    if (told->record < next_.record) {
      add_flaw(fmt::format("record {} is there again, or in a wrong place", told->record));
      return;
    }
    if (told->record > next_.record && !go_over_gap(*told, line)) return;
    const bool fits = next_.fits(line);
    if (!fits)
      add_flaw(fmt::format("record {} was changed", told->record));
    else if (!is_after_gap_ && told->before != next_.seal)
      add_flaw(fmt::format("record {} does not follow the one before it", told->record));
    else
      ++report_.whole;
    is_after_gap_ = false;
    next_.skip();
    next_.seal = told->seal;
  }

  /// `rest` bytes are behind the last line.
  AuditReport finish(size_t rest) {
    if (report_.lines > 0 && report_.whole == 0) {
      // One reason for all of them.
      report_.flaws.clear();
      report_.flaw_count = 0;
      add_flaw("no record fits the key: is it that of this log?");
    }
    check_end(rest);
    report_.seal = to_hex(next_.seal);
    return std::move(report_);
  }

 private:
  /// Goes on at a record that is not the next one, if it is whole. Returns whether to look at it.
  bool go_over_gap(const AuditLine& told, std::string_view line) {
    const uint64_t bound =
        state_ ? std::max(state_->record, next_.record) + kMaxAhead : next_.record + kMaxGap;
    const uint64_t gap = told.record - next_.record;
    AuditLink later = next_;
    if (told.record <= bound && skips_ + gap <= kMaxSkips) {
      skips_ += gap;
      while (later.record < told.record && !stop_.stop_requested()) later.skip();
    }
    if (later.record != told.record || !later.fits(line)) {
      add_flaw(fmt::format("says it is record {}, which it is not", told.record));
      return false;
    }
    add_flaw(records_text(next_.record, told.record));
    next_ = later;
    is_after_gap_ = true;
    return true;
  }

  void check_end(size_t rest) {
    ++report_.lines;  // What is missing would be behind the last line.
    if (rest > 0)
      add_flaw(fmt::format("{} bytes are no record: put in, or a server was killed", rest));
    if (!state_) {
      add_flaw("its end cannot be verified, because its state is not beside it");
    } else if (state_->record > next_.record) {
      add_flaw(records_text(next_.record, state_->record) +
               " at the end: removed, or lost with power");
    } else if (state_->record == next_.record && state_->key != next_.key) {
      add_flaw("its state is that of another log");
    }
    --report_.lines;
  }

  void add_flaw(std::string what) {
    ++report_.flaw_count;
    if (report_.flaws.size() < AuditReport::kMaxFlaws)
      report_.flaws.push_back({report_.lines, std::move(what)});
  }

  AuditLink next_;
  const std::optional<AuditLink> state_;
  const std::stop_token stop_;
  bool is_after_gap_ = false;
  uint64_t skips_ = 0;
  AuditReport report_;
};

/// The state of a log; nothing where it is not there. A server may be writing it, and what was read
/// in the midst of that has a wrong checksum.
Result<std::optional<AuditLink>> whole_state(const std::filesystem::path& path) {
  constexpr int kTries = 100;
  auto link = read_audit_state(path);
  for (int i = 1; i < kTries && link.status().code() == StatusCode::kDataLoss; ++i)
    link = read_audit_state(path);
  if (link.status().code() == StatusCode::kNotFound) return std::optional<AuditLink>();
  ENGRAM_RETURN_IF_ERROR(link.status());
  return std::optional(*link);
}

/// Reads a file in chunks and visits its lines. Returns the number of bytes behind the last one.
Result<size_t> for_each_line(const File& file, const ProgressSink& progress,
                             const std::stop_token& stop,
                             const std::function<void(std::string_view)>& visit) {
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  std::string text;
  const auto interrupted = [&file] {
    return cancelled("'{}' was not read whole", file.path().string());
  };
  for (uint64_t at = 0; at < size;) {
    const size_t kept = text.size();
    text.resize(kept + std::min<uint64_t>(kChunkBytes, size - at));
    ENGRAM_RETURN_IF_ERROR(file.read_at(at, std::as_writable_bytes(std::span(text).subspan(kept))));
    at += text.size() - kept;
    size_t begin = 0;
    for (size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
      visit(std::string_view(text).substr(begin, end - begin));
      begin = end + 1;
      // Hostile lines may take long.
      if (stop.stop_requested()) return interrupted();
    }
    text.erase(0, begin);
    // A line without an end must not fill the RAM.
    if (text.size() > kMaxAuditLine) {
      visit(text);
      text.clear();
    }
    if (stop.stop_requested()) return interrupted();
    if (progress && size > kChunkBytes)
      progress({"verify " + file.path().string(), at, size, "", -1});
  }
  return text.size();
}

}  // namespace

Result<AuditReport> check_audit_log(const std::filesystem::path& path,
                                    const std::filesystem::path& key, const ProgressSink& progress,
                                    const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(std::string secret, read_private_file(key, kMaxKeyBytes));
  secret.resize(secret.find_last_not_of("\r\n") + 1);
  // The state before the log: what a server adds between the two is behind what the state says.
  ENGRAM_ASSIGN_OR_RETURN(const auto state, whole_state(AuditLog::state_path(path)));
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(path, File::Mode::kRead));
  AuditVerifier verifier(AuditLink::first(secret), state, stop);
  ENGRAM_ASSIGN_OR_RETURN(const size_t rest,
                          for_each_line(file, progress, stop, [&verifier](std::string_view line) {
                            verifier.add_line(line);
                          }));
  return verifier.finish(rest);
}

}  // namespace engram::server
