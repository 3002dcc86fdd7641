// SPDX-License-Identifier: Apache-2.0
#include "store/store_measure.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

#include "ltm/core/check.h"
#include "ltm/core/file.h"

namespace engram::experiments {

namespace fs = std::filesystem;

namespace {

Status for_each_file(const fs::path& folder, const std::function<Status(const fs::path&)>& visit) {
  std::error_code error;
  fs::recursive_directory_iterator entries(folder, error);
  for (; !error && entries != fs::recursive_directory_iterator(); entries.increment(error)) {
    const bool is_file = entries->is_regular_file(error);
    if (error) return unavailable("file '{}': {}", entries->path().string(), error.message());
    if (is_file) ENGRAM_RETURN_IF_ERROR(visit(entries->path()));
  }
  if (error == std::errc::no_such_file_or_directory)
    return not_found("folder '{}': {}", folder.string(), error.message());
  if (error) return unavailable("folder '{}': {}", folder.string(), error.message());
  return {};
}

/// Calls `act` with the file's descriptor; `act` returns an error number.
Status with_descriptor(const fs::path& file, const std::function<int(int)>& act) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return unavailable("file '{}': cannot be opened", file.string());
  const int error = act(fd);
  ::close(fd);
  if (error != 0)
    return unavailable("file '{}': {}", file.string(), std::generic_category().message(error));
  return {};
}

}  // namespace

double Stopwatch::restart() {
  const double passed = seconds();
  start_ = std::chrono::steady_clock::now();
  return passed;
}

double cpu_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double quantile(std::vector<double> values, double share) {
  ENGRAM_CHECK(!values.empty(), "no values");
  const double rank = std::ceil(share * static_cast<double>(values.size())) - 1;
  const size_t at = std::min(values.size() - 1, static_cast<size_t>(std::max(0.0, rank)));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

Latency summarize(const std::vector<double>& seconds) {
  return {quantile(seconds, 0.5), quantile(seconds, 0.99), quantile(seconds, 1)};
}

fs::path recordings_folder() {
  const char* folder = std::getenv("ENGRAM_RECORDINGS");
  return folder == nullptr ? "" : folder;
}

Result<std::vector<fs::path>> files_below(const fs::path& folder, std::string_view extension) {
  std::vector<fs::path> files;
  ENGRAM_RETURN_IF_ERROR(for_each_file(folder, [&](const fs::path& file) -> Status {
    if (file.extension() == extension) files.push_back(file);
    return {};
  }));
  std::ranges::sort(files);
  return files;
}

Result<uint64_t> tree_bytes(const fs::path& folder) {
  uint64_t sum = 0;
  ENGRAM_RETURN_IF_ERROR(for_each_file(folder, [&](const fs::path& file) -> Status {
    std::error_code error;
    sum += fs::file_size(file, error);
    return error ? unavailable("file '{}': {}", file.string(), error.message()) : Status();
  }));
  return sum;
}

Status sync_tree(const fs::path& folder) {
  return for_each_file(folder, [](const fs::path& file) {
    return with_descriptor(file, [](int fd) { return ::fdatasync(fd) == 0 ? 0 : errno; });
  });
}

Status drop_cached(const fs::path& folder) {
  // The system drops only pages that are on the disk already.
  ENGRAM_RETURN_IF_ERROR(sync_tree(folder));
  return for_each_file(folder, [](const fs::path& file) {
    return with_descriptor(file,
                           [](int fd) { return ::posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED); });
  });
}

Status make_empty(const fs::path& folder) {
  std::error_code error;
  fs::remove_all(folder, error);
  if (error) return unavailable("folder '{}': {}", folder.string(), error.message());
  return make_directories(folder);
}

Result<Memory> memory() {
  std::ifstream status("/proc/self/status");
  Memory found;
  for (std::string key; status >> key; status.ignore(1024, '\n')) {
    uint64_t kib = 0;
    if (key == "VmRSS:" && status >> kib) found.now_bytes = kib * 1024;
    if (key == "VmHWM:" && status >> kib) found.peak_bytes = kib * 1024;
  }
  if (found.peak_bytes == 0) return unavailable("/proc/self/status: found no VmHWM");
  return found;
}

Status reset_peak_memory() {
  std::ofstream file("/proc/self/clear_refs");
  // Writing 5 resets VmHWM to the current resident size (man 5 proc).
  file << "5" << std::flush;
  return file ? Status() : unavailable("/proc/self/clear_refs: cannot be written");
}

}  // namespace engram::experiments
