// SPDX-License-Identifier: Apache-2.0
#include "server/robot/host_reader.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string>

namespace engram::server {

namespace {

using std::filesystem::path;

/// The max number of bytes read of a file. /proc/stat may be long, but its first line suffices.
constexpr size_t kMaxRead = size_t{64} << 10;
constexpr uint64_t kKilobyte = 1024;
constexpr std::string_view kBlanks = " \t";

/// Reads a file of the kernel. Such files report no size, so they are read until their end.
Result<std::string> read_kernel_file(const path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  if (!stream && !std::filesystem::exists(file, ignored))
    return not_found("'{}': there is no such file", file.string());
  std::string text(kMaxRead, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || (stream.fail() && !stream.eof()))
    return unavailable("'{}': cannot be read", file.string());
  text.resize(static_cast<size_t>(stream.gcount()));
  return text;
}

Status damaged(const path& file, std::string_view needed) {
  return data_loss("'{}': needs {}", file.string(), needed);
}

/// Splits a text into words.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  /// Returns the next word, or an empty one at the end.
  std::string_view next() {
    text_.remove_prefix(std::min(text_.find_first_not_of(kBlanks), text_.size()));
    const std::string_view word = text_.substr(0, text_.find_first_of(kBlanks));
    text_.remove_prefix(word.size());
    return word;
  }

 private:
  std::string_view text_;
};

template <typename T>
std::optional<T> number_of(std::string_view word) {
  T number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

/// Returns the rest of the first line that begins with `start`, or nothing if no line does.
std::optional<std::string_view> line_after(std::string_view text, std::string_view start) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.starts_with(start)) return line.substr(start.size());
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return std::nullopt;
}

/// Parses a line such as "MemTotal:  24684092 kB" and returns bytes.
std::optional<uint64_t> kilobytes_after(std::string_view text, std::string_view start) {
  const auto line = line_after(text, start);
  if (!line) return std::nullopt;
  Words words(*line);
  const auto count = number_of<uint64_t>(words.next());
  if (!count || *count > UINT64_MAX / kKilobyte || words.next() != "kB") return std::nullopt;
  return *count * kKilobyte;
}

/// Parses "max" or a number of bytes, followed by a line break.
std::optional<uint64_t> bytes_of(std::string_view text) {
  const std::string_view word = text.substr(0, text.find('\n'));
  return word == "max" ? UINT64_MAX : number_of<uint64_t>(word);
}

/// Reads the RAM of one control group; nothing if the group has no limit.
Result<std::optional<RamState>> read_group(const path& group) {
  const auto limit_text = read_kernel_file(group / "memory.max");
  if (!limit_text.ok()) return std::optional<RamState>();
  const auto limit = bytes_of(*limit_text);
  if (!limit) return damaged(group / "memory.max", "'max' or bytes");
  if (*limit == UINT64_MAX) return std::optional<RamState>();
  ENGRAM_ASSIGN_OR_RETURN(const std::string used_text, read_kernel_file(group / "memory.current"));
  const auto used = bytes_of(used_text);
  if (!used) return damaged(group / "memory.current", "bytes");
  const std::string statistics = read_kernel_file(group / "memory.stat").value_or("");
  const auto idle = line_after(statistics, "inactive_file ");
  const uint64_t given_back = idle ? number_of<uint64_t>(*idle).value_or(0) : 0;
  const uint64_t needed = *used - std::min(*used, given_back);
  return std::optional(RamState{*limit, *limit - std::min(*limit, needed)});
}

/// Parses a line such as "some avg10=1.50 avg60=..." and returns the share of the last 10 s in %.
std::optional<double> ten_seconds(std::string_view line) {
  constexpr std::string_view kStart = "avg10=";
  Words words(line);
  const std::string_view word = words.next();
  if (!word.starts_with(kStart)) return std::nullopt;
  const auto share = number_of<double>(word.substr(kStart.size()));
  return share && *share >= 0 && *share <= 100 ? share : std::nullopt;
}

DiskState read_disk(const path& disk) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(disk, error);
  if (error) return {disk.string(), std::nullopt, std::nullopt};
  return {disk.string(), space.capacity, space.available};
}

}  // namespace

Result<HostState> HostReader::read() {
  HostState state;
  ENGRAM_ASSIGN_OR_RETURN(const CpuTimes times, read_cpu_times());
  // The kernel documents that single counters may decrease, so only a growing total is used.
  if (last_ && times.total > last_->total) {
    const auto all = static_cast<double>(times.total - last_->total);
    const double idle = static_cast<double>(times.idle) - static_cast<double>(last_->idle);
    state.cpu_share = std::clamp(1 - idle / all, 0.0, 1.0);
  }
  last_ = times;
  ENGRAM_ASSIGN_OR_RETURN(state.ram, read_ram());
  ENGRAM_ASSIGN_OR_RETURN(state.group_ram, read_group_ram());
  ENGRAM_ASSIGN_OR_RETURN(state.cpu_pressure, read_pressure("cpu"));
  ENGRAM_ASSIGN_OR_RETURN(state.memory_pressure, read_pressure("memory"));
  ENGRAM_ASSIGN_OR_RETURN(state.io_pressure, read_pressure("io"));
  for (const path& disk : options_.disks) state.disks.push_back(read_disk(disk));
  ENGRAM_ASSIGN_OR_RETURN(state.process_bytes, read_process_bytes());
  return state;
}

Result<HostReader::CpuTimes> HostReader::read_cpu_times() const {
  // The counters are user, nice, system, idle, iowait, irq, softirq and steal. Guest time is
  // already part of user.
  constexpr size_t kCounters = 8;
  constexpr size_t kIdle = 3;
  constexpr size_t kIoWait = 4;
  const path file = options_.root / "proc/stat";
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, read_kernel_file(file));
  const auto line = line_after(text, "cpu ");
  if (!line) return damaged(file, "a line 'cpu'");
  Words words(*line);
  CpuTimes times;
  for (size_t i = 0; i < kCounters; ++i) {
    const auto ticks = number_of<uint64_t>(words.next());
    if (!ticks) return damaged(file, "eight counters behind 'cpu'");
    times.total += *ticks;
    if (i == kIdle || i == kIoWait) times.idle += *ticks;
  }
  return times;
}

Result<RamState> HostReader::read_ram() const {
  const path file = options_.root / "proc/meminfo";
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, read_kernel_file(file));
  const auto total = kilobytes_after(text, "MemTotal:");
  const auto available = kilobytes_after(text, "MemAvailable:");
  if (!total || !available || *total == 0) return damaged(file, "MemTotal and MemAvailable in kB");
  return RamState{*total, *available};
}

Result<std::optional<RamState>> HostReader::read_group_ram() const {
  const auto text = read_kernel_file(options_.root / "proc/self/cgroup");
  const auto own = text.ok() ? line_after(*text, "0::/") : std::nullopt;
  if (!own) return std::optional<RamState>();
  const path top = options_.root / "sys/fs/cgroup";
  path group = path(*own).lexically_normal();
  // The process is outside its cgroup namespace, so only the outermost group is visible.
  if (!group.empty() && *group.begin() == "..") group.clear();
  std::optional<RamState> tightest;
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const auto found, read_group(top / group));
    if (found && (!tightest || found->available_bytes < tightest->available_bytes))
      tightest = found;
    if (group.empty()) return tightest;
    group = group.parent_path();
  }
}

Result<std::optional<Pressure>> HostReader::read_pressure(std::string_view resource) const {
  const path file = options_.root / "proc/pressure" / resource;
  const auto text = read_kernel_file(file);
  if (!text.ok()) return std::optional<Pressure>();
  const auto some = line_after(*text, "some ");
  const auto share = some ? ten_seconds(*some) : std::nullopt;
  if (!share) return damaged(file, "a line 'some avg10='");
  Pressure pressure{*share, std::nullopt};
  if (const auto full = line_after(*text, "full ")) {
    pressure.full = ten_seconds(*full);
    if (!pressure.full) return damaged(file, "a line 'full avg10='");
  }
  return std::optional(pressure);
}

Result<uint64_t> HostReader::read_process_bytes() const {
  const path file = options_.root / "proc/self/status";
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, read_kernel_file(file));
  if (const auto bytes = kilobytes_after(text, "VmRSS:")) return *bytes;
  return damaged(file, "VmRSS in kB");
}

}  // namespace engram::server
