// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/memory/snapshot.h"
#include "ltm/redaction/box.h"
#include "ltm/redaction/redaction_options.h"

namespace engram::ltm {

/// What was done to the images of snapshots.
struct RedactionCounters {
  uint64_t images = 0;      ///< That detectors looked at.
  uint64_t redacted = 0;    ///< Images of which parts were made unrecognisable.
  uint64_t boxes = 0;       ///< That detectors found.
  uint64_t dropped = 0;     ///< Dropped snapshots, for any of the reasons below or by the action.
  uint64_t unanswered = 0;  ///< Snapshots without an answer of the detector, in time or at all.
  /// Snapshots with an image in a form in which no detector looks, or with too many images.
  uint64_t unreadable = 0;

  void add(const RedactionCounters& more);
};

/// A box that was found in an image of a snapshot, with its margins.
struct SeenBox {
  ImagePlace place;
  RelativeBox box;
};

/// The outcome for one snapshot.
struct RedactionOutcome {
  /// If it is not empty, the snapshot must not be kept or shown, for this reason.
  std::string dropped;
  /// The detector gave no answer: another try may succeed.
  bool is_unanswered = false;
  /// It has an image or video in a form in which no detector looks, or too many images.
  bool is_unreadable = false;
  uint64_t redacted = 0;  ///< Images that were changed.
  uint64_t boxes = 0;     ///< That were found now; those that were held come on top.
  /// What was found now, as far as it is within the images.
  std::vector<SeenBox> seen;
  /// The buffers that held images before they were changed. What shares an owner with them still
  /// holds them.
  std::vector<Buffer> originals;

  [[nodiscard]] bool is_dropped() const { return !dropped.empty(); }
};

/// Whether boxes that were found in earlier snapshots of an entity count in later ones.
enum class RedactionMemory : uint8_t {
  kHold,  ///< They do, for RedactionOptions::hold. Snapshots come about in the order of time.
  kNone,  ///< Each snapshot is looked at alone, as for one answer.
};

/// Makes unrecognisable what detectors find in the images of snapshots.
///
/// Every array that looks like an image counts, wherever it is in a value. What is found in one
/// image of an instance is redacted in all its images of the same size, so depth follows colour.
/// Buffers are never written to: arrays are copied where they change. A snapshot is dropped, and
/// not passed on, if a detector gives no answer, if it has JPEG, PNG, video, pixels or the like in
/// bytes, in which no detector looks, or if it has more than 256 images.
/// Threading: thread-safe. Detectors that are not parallel take turns.
/// Source: docs/recording.md, section "Redaction".
class Redactor {
 public:
  /// The first rule that matches an entity counts. Starts programs and loads files.
  /// Errors: kInvalidArgument; those of make_detector, with the rule's pattern.
  static Result<std::unique_ptr<Redactor>> create(std::vector<RedactionRule> rules);
  ~Redactor();

  /// Whether the images of an entity are redacted.
  [[nodiscard]] bool applies_to(const MemoryId& entity) const;
  /// Whether those of some entity of a memory may be.
  [[nodiscard]] bool may_apply_in(std::string_view memory) const;

  /// Redacts a snapshot in place. Its values must have the type of their segment already, because a
  /// cast may make an image of what was none.
  RedactionOutcome redact(Snapshot& snapshot, RedactionMemory memory = RedactionMemory::kHold);

  /// The same for the values of an entity at a time that are no snapshot, such as an answer's.
  RedactionOutcome redact(const MemoryId& entity, Time time, std::span<idf::Data* const> values,
                          RedactionMemory memory);

  /// Holds boxes as if they had been found in a snapshot of this time, and counts nothing. For who
  /// goes on where another process ended.
  void hold(const MemoryId& entity, Time time, std::span<const SeenBox> boxes);

  /// Waits until all detectors can answer, for those who have time: see Detector::wait_ready.
  Status wait_ready(const std::stop_token& stop);

  /// Of all calls so far.
  [[nodiscard]] RedactionCounters counters() const;

 private:
  struct State;
  explicit Redactor(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
