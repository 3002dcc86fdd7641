// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "ltm/filter/event_rule.h"
#include "ltm/filter/frequency_filter.h"
#include "ltm/filter/window_buffer.h"

namespace engram::ltm {

/// Keeps the candidates around events. ImportanceFilter and TriggerFilter are made of it.
///
/// Threading: one thread.
class EventWindows {
 public:
  EventWindows(const std::vector<EventRule>& events, const WindowBuffer::Options& windows);

  void offer(Candidate candidate, bool is_wanted, FilterDecisions& decisions);
  void notice(const Snapshot& snapshot, const std::optional<idf::Type>& type,
              FilterDecisions& decisions);
  void flush(FilterDecisions& decisions) { buffer_.flush(decisions); }
  [[nodiscard]] bool listens_to(const MemoryId& entity) const;
  [[nodiscard]] bool is_open_at(Time time) const { return buffer_.is_open_at(time); }
  [[nodiscard]] HeldSnapshots held() const { return buffer_.held(); }
  void add_held_times(TimeSet& times) const { buffer_.add_held_times(times); }
  void forget(const TimeSet& times, FilterDecisions& decisions) {
    buffer_.forget(times, decisions);
  }

 private:
  std::vector<EventDetector> detectors_;
  WindowBuffer buffer_;
};

/// Keeps everything within a window around events. Outside the windows it keeps nothing, or a base
/// rate.
///
/// Candidates are held for up to `before`, because an event may still come. It sees events of the
/// entity itself only if the filters before it keep them, so put it first.
class ImportanceFilter final : public Filter {
 public:
  struct Options {
    std::vector<EventRule> events;  ///< At least one.
    Duration before = std::chrono::seconds(5);
    Duration after = std::chrono::seconds(5);
    /// Max rate that is kept outside the windows. Empty: nothing is kept. Unit: snapshots per
    /// second.
    std::optional<double> base_rate_hz;
    /// Max bytes that are held per entity. Beyond it the oldest candidates are dropped.
    uint64_t max_held_bytes = uint64_t{256} << 20;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<ImportanceFilter> create(const Options& options);

  [[nodiscard]] std::string_view name() const override { return "importance"; }
  void offer(Candidate candidate, FilterDecisions& decisions) override;
  void flush(FilterDecisions& decisions) override { windows_.flush(decisions); }
  [[nodiscard]] HeldSnapshots held() const override { return windows_.held(); }
  void add_held_times(TimeSet& times) const override { windows_.add_held_times(times); }
  bool forget(const TimeSet& times, FilterDecisions& decisions) override {
    windows_.forget(times, decisions);
    return true;
  }
  [[nodiscard]] bool listens_to(const MemoryId& entity) const override {
    return windows_.listens_to(entity);
  }
  void notice(const Snapshot& snapshot, const std::optional<idf::Type>& type,
              FilterDecisions& decisions) override {
    windows_.notice(snapshot, type, decisions);
  }

 private:
  ImportanceFilter(EventWindows windows, std::optional<FrequencyFilter> base)
      : windows_(std::move(windows)), base_(std::move(base)) {}

  EventWindows windows_;
  std::optional<FrequencyFilter> base_;
};

/// Keeps nothing until an event; then it keeps the time before the event and what follows.
///
/// It works as a ring buffer in memory. See ImportanceFilter for what it sees and holds.
class TriggerFilter final : public Filter {
 public:
  struct Options {
    std::vector<EventRule> events;  ///< At least one.
    Duration before = std::chrono::seconds(10);
    /// Time that is kept after each event. Empty: everything after the first event is kept.
    std::optional<Duration> after;
    uint64_t max_held_bytes = uint64_t{256} << 20;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<TriggerFilter> create(const Options& options);

  [[nodiscard]] std::string_view name() const override { return "trigger"; }
  void offer(Candidate candidate, FilterDecisions& decisions) override {
    windows_.offer(std::move(candidate), false, decisions);
  }
  void flush(FilterDecisions& decisions) override { windows_.flush(decisions); }
  [[nodiscard]] HeldSnapshots held() const override { return windows_.held(); }
  void add_held_times(TimeSet& times) const override { windows_.add_held_times(times); }
  bool forget(const TimeSet& times, FilterDecisions& decisions) override {
    windows_.forget(times, decisions);
    return true;
  }
  [[nodiscard]] bool listens_to(const MemoryId& entity) const override {
    return windows_.listens_to(entity);
  }
  void notice(const Snapshot& snapshot, const std::optional<idf::Type>& type,
              FilterDecisions& decisions) override {
    windows_.notice(snapshot, type, decisions);
  }

 private:
  explicit TriggerFilter(EventWindows windows) : windows_(std::move(windows)) {}

  EventWindows windows_;
};

}  // namespace engram::ltm
