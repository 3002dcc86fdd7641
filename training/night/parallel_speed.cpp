// SPDX-License-Identifier: Apache-2.0
#include "training/night/parallel_speed.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <numeric>
#include <thread>

#include "encoders/layers.h"
#include "encoders/threads.h"

namespace engram::training {

using torch::Tensor;

namespace {

/// A small network with convolutions like those of the autoencoder at 1/4 and 1/16 of the
/// resolution.
class SmallTraining {
 public:
  void step() {
    const Tensor loss =
        quarter_(quarter_input_).square().mean() + sixteenth_(sixteenth_input_).square().mean();
    quarter_->zero_grad();
    sixteenth_->zero_grad();
    loss.backward();
  }

 private:
  static Tensor input(int64_t features, int64_t side) {
    return torch::randn({8, features, side, side}).contiguous(at::MemoryFormat::ChannelsLast);
  }

  encoders::ResidualBlock quarter_{48}, sixteenth_{128};
  Tensor quarter_input_ = input(48, 32), sixteenth_input_ = input(128, 8);
};

/// Steps per second of a training in this thread, measured for `time`.
double speed_of(SmallTraining& training, std::chrono::duration<double> time) {
  using Clock = std::chrono::steady_clock;
  training.step();  // The first step includes preparation and does not count.
  const auto start = Clock::now();
  int steps = 0;
  for (; Clock::now() - start < time; ++steps) training.step();
  return steps / std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

ParallelSpeed measure_parallel_speed() {
  constexpr std::chrono::duration<double> kTime{0.25};
  constexpr int kRounds = 2;
  SmallTraining first, second;
  ParallelSpeed speed;
  for (int round = 0; round < kRounds; ++round) {
    encoders::set_threads(2);
    speed.one_of_two += speed_of(first, kTime) / kRounds;
    double beside = 0;
    std::thread other([&] {
      encoders::set_threads(1);
      beside = speed_of(second, kTime);
    });
    encoders::set_threads(1);
    speed.two_of_one += speed_of(first, kTime) / kRounds;
    other.join();
    speed.two_of_one += beside / kRounds;
  }
  return speed;
}

std::vector<std::vector<size_t>> split_in_two(std::span<const double> weights) {
  std::vector<size_t> order(weights.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](size_t i) { return weights[i]; });
  std::vector<std::vector<size_t>> groups(2);
  std::vector<double> sums(2);
  for (const size_t i : order) {
    const size_t lighter = sums[1] < sums[0] ? 1 : 0;
    groups[lighter].push_back(i);
    sums[lighter] += weights[i];
  }
  if (sums[1] > sums[0]) std::swap(groups[0], groups[1]);
  return groups;
}

bool two_are_quicker(std::span<const double> shares, const ParallelSpeed& speed) {
  const auto groups = split_in_two(shares);
  if (groups[1].empty()) return false;
  double heavier = 0;
  for (const size_t i : groups[0]) heavier += shares[i];
  // Each of two processes has half of their joint speed, and the heavier group decides the time.
  return speed.two_of_one / (2 * heavier) > speed.one_of_two;
}

}  // namespace engram::training
