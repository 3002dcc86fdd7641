// SPDX-License-Identifier: Apache-2.0
// What an index of nearest neighbours (hnswlib) would cost and find beside the scan of all codes
// that `engram similar` makes, docs/recall.md. Usage: engram_neighbour_index [moments]
#include <fmt/format.h>
#include <unistd.h>

#include <hnswlib/hnswlib.h>
#include <algorithm>
#include <atomic>
#include <ctime>
#include <fstream>
#include <numeric>
#include <random>
#include <thread>

#include "ltm/likeness/coded_moments.h"

namespace engram::ltm {
namespace {

constexpr size_t kFound = 10;
constexpr size_t kQuestions = 200;
constexpr Duration kContext = std::chrono::seconds(2);
constexpr std::array<int, 5> kLags_ms{0, 200, 600, 1000, 2000};
constexpr size_t kWidth = kLags_ms.size() * kCodeSize;
using Found = std::vector<size_t>;

/// Unit: seconds of processor time of all threads.
double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Unit: bytes that the process has in memory.
size_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  size_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<size_t>(::sysconf(_SC_PAGESIZE));
}

/// Recordings of a minute at 5 Hz. Each walks about one of 50 scenes, as cameras do.
CodedMoments walking_codes(size_t count) {
  std::mt19937 random(1);
  std::normal_distribution<double> scene(0, 9), step(0, 1.2);
  std::vector<std::array<double, kCodeSize>> scenes(50);
  for (auto& one : scenes)
    for (double& number : one) number = scene(random);
  CodedMoments coded;
  coded.numbers = kCodeSize;
  std::array<double, kCodeSize> at{}, home{};
  for (size_t i = 0; i < count; ++i) {
    const auto recording = static_cast<int64_t>(i / 300);
    if (i % 300 == 0) at = home = scenes[random() % scenes.size()];
    coded.times.push_back(
        time_from_ns(recording * 3'600'000'000'000 + static_cast<int64_t>(i) * 200'000'000));
    for (size_t j = 0; j < kCodeSize; ++j) {
      at[j] += 0.02 * (home[j] - at[j]) + step(random);
      coded.bytes.push_back(static_cast<int8_t>(std::clamp(at[j], -127.0, 127.0)));
    }
  }
  coded.finish();
  return coded;
}

/// What is compared of a moment, as one row: its code, and those of what came before.
std::vector<uint8_t> row_of(const CodedMoments& coded, size_t moment) {
  std::vector<uint8_t> row;
  for (const int lag : kLags_ms) {
    const size_t at = coded.before(moment, std::chrono::milliseconds(lag));
    for (size_t j = 0; j < kCodeSize; ++j)
      row.push_back(static_cast<uint8_t>(coded.bytes[at * kCodeSize + j] + 128));
  }
  return row;
}

Found nearest(const std::vector<float>& distances, size_t begin, size_t end) {
  Found found(end - begin);
  std::iota(found.begin(), found.end(), begin);
  std::ranges::partial_sort(found, found.begin() + kFound, {},
                            [&distances](size_t i) { return distances[i]; });
  found.resize(kFound);
  return found;
}

/// The share of `exact` that was found, or that is as near as the farthest of it.
double recall(const std::vector<float>& distances, const Found& exact, const Found& found) {
  const float limit = distances[exact.back()];
  const auto right = std::ranges::count_if(found, [&](size_t i) { return distances[i] <= limit; });
  return std::min(1.0, static_cast<double>(right) / static_cast<double>(exact.size()));
}

using Index = hnswlib::HierarchicalNSW<int>;

Found ask(Index& index, const std::vector<uint8_t>& row, size_t count) {
  auto queue = index.searchKnn(row.data(), count);
  Found found;
  for (; !queue.empty(); queue.pop()) found.push_back(queue.top().second);
  std::ranges::reverse(found);
  return found;
}

/// Those of [begin, end) among the nearest, however few these are.
Found only(const Found& all, size_t begin, size_t end) {
  Found found;
  for (const size_t i : all)
    if (i >= begin && i < end && found.size() < kFound) found.push_back(i);
  return found;
}

void measure(const CodedMoments& coded, Index& index) {
  const size_t count = coded.size(), part = count / 100;
  std::mt19937 random(2);
  std::vector<size_t> asked(kQuestions);
  for (size_t& one : asked) one = random() % count;
  double scan = 0;
  std::vector<std::vector<float>> distances;
  std::vector<Found> exact, exact_part;
  for (const size_t one : asked) {
    const double start = processor_seconds();
    distances.push_back(coded.square_distances(one, kContext));
    scan += processor_seconds() - start;
    exact.push_back(nearest(distances.back(), 0, count));
    exact_part.push_back(nearest(distances.back(), count - part, count));
  }
  fmt::print("scan of all: {:.1f} ms of processor time a question\n", 1e3 * scan / kQuestions);
  fmt::print("{:>6} {:>8} {:>12} {:>22}\n", "ef", "ms", "recall@10", "within 1 %: recall@10");
  for (const size_t ef : {32, 100, 400, 2000}) {
    index.setEf(ef);
    double spent = 0, right = 0, right_part = 0;
    for (size_t i = 0; i < kQuestions; ++i) {
      const auto row = row_of(coded, asked[i]);
      const double start = processor_seconds();
      const Found found = ask(index, row, kFound);
      spent += processor_seconds() - start;
      right += recall(distances[i], exact[i], found);
      // The packaged version takes no filter, so as many as it looks at are asked for.
      const Found kept = only(ask(index, row, ef), count - part, count);
      right_part += recall(distances[i], exact_part[i], kept);
    }
    fmt::print("{:>6} {:>8.3f} {:>12.3f} {:>22.3f}\n", ef, 1e3 * spent / kQuestions,
               right / kQuestions, right_part / kQuestions);
  }
}

void run(size_t count) {
  const CodedMoments coded = walking_codes(count);
  fmt::print("{} moments of {} bytes, a context of 2 s\n", count, kCodeSize);
  hnswlib::L2SpaceI space(kWidth);
  const size_t before = resident_bytes();
  Index index(&space, count, 16, 200);
  const double start = processor_seconds();
  index.addPoint(row_of(coded, 0).data(), 0);
  std::atomic<size_t> next{1};
  {
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i)
      threads.emplace_back([&] {
        for (size_t at = next++; at < count; at = next++)
          index.addPoint(row_of(coded, at).data(), at);
      });
  }
  fmt::print("index: built in {:.0f} s of processor time, {} bytes a moment\n",
             processor_seconds() - start, (resident_bytes() - before) / count);
  measure(coded, index);
}

}  // namespace
}  // namespace engram::ltm

int main(int argc, char** argv) {
  const size_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000;
  if (count < 10'000) {
    fmt::print(stderr, "usage: {} [moments], needs 10000 or more\n", argv[0]);
    return 2;
  }
  engram::ltm::run(count);
}
