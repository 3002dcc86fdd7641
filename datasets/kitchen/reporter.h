// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the data that is recorded of a world.

#include <optional>
#include <string>

#include "datasets/kitchen/facts.h"
#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/kitchen_types.h"
#include "datasets/kitchen/renderer.h"
#include "datasets/kitchen/script.h"

namespace engram::datasets::kitchen {

/// Turns the state of a world into snapshots, and passes on those of one time together.
///
/// Threading: one thread. World, renderer and sink must outlive it.
class Reporter {
 public:
  /// `renderer` is null where the options are without images. Then nothing of `Vision` is recorded,
  /// and no link leads there.
  Reporter(const KitchenOptions& options, const DrawingSize& size, const World& world,
           Renderer* renderer, CommitSink sink);

  /// Rate of samples. Each has joints and platform.
  static constexpr int kRate_hz = 100;
  static constexpr int kImageEvery = 5;     ///< Samples per image: 20 Hz.
  static constexpr int kObjectsEvery = 20;  ///< Samples per object pose: 5 Hz.

  /// Returns the time of a sample; sample 0 is the start.
  [[nodiscard]] Time time_of(uint64_t sample) const;

  /// Reports what is known before anything moves, at time_of(0).
  void report_prior(const Layout& layout);

  /// These report speech, plans and actions at the time of the sample that is recorded next, and
  /// return their IDs, for links. With actions, object poses of the same time are recorded.
  /// `skill`: its name without the robot's.
  ltm::MemoryId report_speech(uint64_t sample, const std::string& speaker, const std::string& text);
  ltm::MemoryId report_plan(uint64_t sample, const ::kitchen::Plan& plan);
  ltm::MemoryId report_request(uint64_t sample, const std::string& skill,
                               const ::skill::ExecutionRequest& request);
  ltm::MemoryId report_action(uint64_t sample, const std::string& skill,
                              const ::kitchen::Action& action);

  /// Records joints and platform and, if they are due, images and objects, and commits them with
  /// everything that was reported since the last call. The world must be refreshed.
  Status record(uint64_t sample);

  /// What belongs to a time, where it is recorded.
  [[nodiscard]] facts::Links links_at(Time time) const;

  [[nodiscard]] bool has_images() const { return renderer_ != nullptr; }
  [[nodiscard]] uint64_t raw_bytes() const { return raw_bytes_; }

 private:
  void add(ltm::MemoryId entity, uint64_t sample, std::vector<idf::Data> values,
           std::string_view provider);
  void add_images(uint64_t sample);
  void add_objects(uint64_t sample);
  void add_robot(uint64_t sample);

  KitchenOptions options_;
  DrawingSize size_;
  const World& world_;
  Renderer* renderer_;
  CommitSink sink_;
  ltm::Commit pending_;
  bool objects_are_due_ = false;
  uint64_t raw_bytes_ = 0;
};

}  // namespace engram::datasets::kitchen
