// SPDX-License-Identifier: Apache-2.0
#include "training/measure/access_time.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

namespace engram::training {

namespace {

using Entries = std::vector<const ltm::SnapshotEntry*>;

constexpr size_t kMaxSnapshots = 300;

/// The time of each read, in ms.
Result<std::vector<double>> times_of(ltm::StoreReader& reader, const ltm::ModelInfo& model,
                                     const Entries& entries, ltm::Encoder& encoder) {
  std::vector<double> times;
  for (const ltm::SnapshotEntry* entry : entries) {
    const auto start = std::chrono::steady_clock::now();
    ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader.read_latent(model.entity, *entry));
    if (snapshot.model_version != model.version) continue;
    for (const ltm::LatentInstance& instance : snapshot.instances)
      ENGRAM_RETURN_IF_ERROR(encoder.decode({&instance.latent, 1}).status());
    times.push_back(to_seconds(std::chrono::steady_clock::now() - start) * 1e3);
  }
  return times;
}

double mean(const std::vector<double>& times) {
  return std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
}

/// The time within which this share of the reads end. `times` is not empty.
double quantile(std::vector<double> times, double share) {
  const auto place =
      times.begin() + static_cast<ptrdiff_t>(share * static_cast<double>(times.size() - 1));
  std::ranges::nth_element(times, place);
  return *place;
}

}  // namespace

Result<AccessTimes> measure_access(ltm::StoreReader& reader, const ltm::ModelInfo& model,
                                   const std::vector<ltm::SnapshotEntry>& index,
                                   ltm::Encoder& encoder) {
  constexpr double kGoldenRatio = 0.618034;  // Fractions of its multiples are far apart.
  Entries coded;
  for (const ltm::SnapshotEntry& entry : index)
    if (entry.latent) coded.push_back(&entry);
  const size_t count = std::min(coded.size(), kMaxSnapshots);
  const Entries in_order(coded.begin(), coded.begin() + static_cast<ptrdiff_t>(count));
  Entries scattered;
  for (size_t i = 0; i < count; ++i) {
    const double share = std::fmod(kGoldenRatio * static_cast<double>(i), 1.0);
    scattered.push_back(coded[static_cast<size_t>(share * static_cast<double>(coded.size()))]);
  }
  AccessTimes times;
  ENGRAM_ASSIGN_OR_RETURN(const auto ordered, times_of(reader, model, in_order, encoder));
  ENGRAM_ASSIGN_OR_RETURN(const auto apart, times_of(reader, model, scattered, encoder));
  if (ordered.empty() || apart.empty()) return times;
  times.in_order_ms = mean(ordered);
  times.scattered_ms = quantile(apart, 0.5);
  times.scattered_p99_ms = quantile(apart, 0.99);
  return times;
}

}  // namespace engram::training
