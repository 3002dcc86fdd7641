// SPDX-License-Identifier: Apache-2.0
#include "store/recorder_limits.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "ltm/core/file.h"
#include "store/store_measure.h"

namespace engram::experiments {

namespace {

/// The copies go to alternating places, so that none of them is in the cache.
double copy_stream(const Stream& stream) {
  std::vector<std::byte> room(size_t{64} << 20, std::byte{1});
  size_t at = 0;
  const auto copy = [&](std::span<const std::byte> bytes) {
    if (at + bytes.size() > room.size()) at = 0;
    std::memcpy(room.data() + at, bytes.data(), bytes.size());
    at += bytes.size();
  };
  double sum = 0;
  for (size_t i = 0; i < stream.ticks(); ++i) {
    const Tick tick = stream.tick(i);
    const Stopwatch clock;
    for (const idf::NdArray& image : tick.images) copy(image.bytes());
    copy(std::as_bytes(std::span(tick.positions)));
    copy(std::as_bytes(std::span(tick.velocities)));
    sum += clock.seconds();
  }
  return sum;
}

Result<double> write_bytes(const Stream& stream, uint64_t count,
                           const std::filesystem::path& path) {
  ENGRAM_RETURN_IF_ERROR(remove_file(path));
  const Stopwatch clock;
  ENGRAM_ASSIGN_OR_RETURN(File file, File::open(path, File::Mode::kCreate));
  for (size_t i = 0; count > 0; ++i) {
    const auto block = stream.frames()[i % stream.frames().size()].bytes();
    const size_t size = std::min<uint64_t>(count, block.size());
    ENGRAM_RETURN_IF_ERROR(file.append(block.first(size)));
    count -= size;
  }
  ENGRAM_RETURN_IF_ERROR(file.sync());
  const double seconds = clock.seconds();
  ENGRAM_RETURN_IF_ERROR(remove_file(path));
  return seconds;
}

}  // namespace

Result<Limits> measure_limits(const Stream& stream, uint64_t stored_bytes,
                              const std::filesystem::path& folder) {
  ENGRAM_RETURN_IF_ERROR(make_directories(folder));
  Limits limits;
  limits.copy_seconds = copy_stream(stream);
  ENGRAM_ASSIGN_OR_RETURN(limits.write_seconds,
                          write_bytes(stream, stored_bytes, folder / "limit"));
  return limits;
}

}  // namespace engram::experiments
