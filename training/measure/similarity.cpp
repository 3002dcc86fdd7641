// SPDX-License-Identifier: Apache-2.0
#include "training/measure/similarity.h"

#include <algorithm>
#include <limits>

#include "training/quality/quality_metrics.h"

namespace engram::training {

namespace {

constexpr size_t kMaxAsking = 64;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double distance(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += difference * difference;
  }
  return sum;
}

/// One queried snapshot and the distances of all others. Its distance to itself is infinite.
struct Asking {
  size_t index = 0;
  idf::Data value;
  std::vector<double> by_code, by_pixels;
};

size_t nearest(const std::vector<double>& distances) {
  return static_cast<size_t>(std::ranges::min_element(distances) - distances.begin());
}

void add(const Asking& asking, const Sequence& recording, SimilaritySums& sums) {
  const auto is_neighbour = [&](size_t other) {
    const bool is_same = recording.first <= other && other < recording.end;
    return is_same && (other + 1 == asking.index || other == asking.index + 1);
  };
  const size_t found = nearest(asking.by_code);
  const double pixels = asking.by_pixels[found];
  sums.rank += 1.0 + static_cast<double>(std::ranges::count_if(
                         asking.by_pixels, [&](double other) { return other < pixels; }));
  if (is_neighbour(found)) ++sums.neighbours;
  if (is_neighbour(nearest(asking.by_pixels))) ++sums.pixel_neighbours;
  ++sums.snapshots;
  sums.others += asking.by_pixels.size() - 1;
}

}  // namespace

void SimilaritySums::add(const SimilaritySums& more) {
  snapshots += more.snapshots;
  others += more.others;
  rank += more.rank;
  neighbours += more.neighbours;
  pixel_neighbours += more.pixel_neighbours;
}

SimilarityQuality SimilaritySums::quality() const {
  if (snapshots == 0) return {};
  const auto count = static_cast<double>(snapshots);
  return {snapshots, others / snapshots, rank / count, static_cast<double>(neighbours) / count,
          static_cast<double>(pixel_neighbours) / count};
}

Result<SimilaritySums> measure_similarity(std::span<const std::vector<float>> codes,
                                          const Sequence& asking,
                                          const std::function<Result<idf::Data>(size_t)>& read,
                                          const std::stop_token& stop) {
  SimilaritySums sums;
  if (codes.size() < 2 || codes.front().empty()) return sums;
  const size_t stride = (asking.size() + kMaxAsking - 1) / kMaxAsking;
  std::vector<Asking> all;
  for (size_t i = asking.first; i < asking.end; i += stride) {
    ENGRAM_ASSIGN_OR_RETURN(idf::Data value, read(i));
    all.push_back({i, std::move(value), {}, {}});
  }
  for (size_t other = 0; other < codes.size(); ++other) {
    if (stop.stop_requested()) return cancelled("measuring similarity was stopped");
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data value, read(other));
    for (Asking& one : all) {
      const auto error = compare(one.value, value);
      const bool counts = other != one.index && error.ok();
      one.by_pixels.push_back(counts ? error->image_mse : kInfinity);
      one.by_code.push_back(counts ? distance(codes[one.index], codes[other]) : kInfinity);
    }
  }
  for (const Asking& one : all) add(one, asking, sums);
  return sums;
}

}  // namespace engram::training
