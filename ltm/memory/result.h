// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/member_prediction.h"
#include "ltm/memory/snapshot.h"
#include "ltm/memory/source.h"

namespace engram::ltm {

/// The probability that the real error of a prediction is within its bound.
inline constexpr double kBoundProbability = 0.9;

/// One instance of an answer.
struct InstanceResult {
  int32_t index = 0;
  idf::Data data;             ///< Empty where the query requested IDs only.
  InstanceMetadata metadata;  ///< Default where the query requested IDs only.
  /// The measured (reconstructed) or expected (predicted) error; nothing where it was recorded.
  std::optional<MeasuredError> error = {};
  /// The bound that the error of a prediction keeps with probability kBoundProbability, NaN where
  /// it is not known; of what faded from latents the largest possible error. Nothing for others.
  std::optional<MeasuredError> bound = {};
  /// How each tensor member was predicted, in the order of the value's layout; empty unless
  /// predicted by a choice of engines. `error` and `bound` are the means of those members here that
  /// count in errors.
  std::vector<MemberPrediction> members = {};

  friend bool operator==(const InstanceResult&, const InstanceResult&) = default;
};

/// One moment of an entity in an answer. All of its instances have the same source.
struct SnapshotResult {
  Time time{};
  Source source = Source::kRecorded;
  /// "Vision/RGB/head/cam v1" where a model decoded or predicted it, otherwise empty.
  std::string model;
  /// The name of the engine that predicted it: "copy-last" where it holds nothing but copies,
  /// "mixed" where several engines predicted its members (see InstanceResult::members). Empty
  /// unless predicted.
  std::string predictor;
  /// The time since the last known snapshot; zero unless predicted.
  Duration horizon{};
  /// The entity whose planned numbers the prediction used; empty without a plan.
  std::string plan{};
  std::vector<InstanceResult> instances;  ///< In the order of their indices.

  /// Null where there is no such instance.
  [[nodiscard]] const InstanceResult* find(int32_t index) const;

  /// Adds an instance after the others, with the next index.
  void append(idf::Data data, const InstanceMetadata& metadata,
              std::optional<MeasuredError> error = {}, std::optional<MeasuredError> bound = {});

  friend bool operator==(const SnapshotResult&, const SnapshotResult&) = default;
};

struct EntityResult {
  MemoryId id;
  std::vector<SnapshotResult> snapshots;  ///< In the order of time; may be empty.

  /// Null where there is no such snapshot. Complexity: O(log n).
  [[nodiscard]] const SnapshotResult* find(Time time) const;

  /// Inserts a snapshot at its time. Of two with the same time the one with the better source stays
  /// (see Source). Two of the same source are united by instance, and the instances that were here
  /// first stay.
  /// Complexity: O(1) in the order of time, otherwise O(n).
  void add(SnapshotResult snapshot);

  friend bool operator==(const EntityResult&, const EntityResult&) = default;
};

/// A segment or a memory in an answer, and the levels below it.
template <typename Below>
struct NameResult {
  std::string name;
  std::vector<Below> below;  ///< In the order of names; never empty.

  friend bool operator==(const NameResult&, const NameResult&) = default;
};

using ProviderSegmentResult = NameResult<EntityResult>;
using CoreSegmentResult = NameResult<ProviderSegmentResult>;
using MemoryResult = NameResult<CoreSegmentResult>;

/// The answer to a query: a tree of the six levels from memory to instance, each in its order. It
/// also holds entities that match but have no selected snapshot.
///
/// Threading: immutable except for add_entity, merge and assignment.
/// Source: docs/query.md.
class QueryResult {
 public:
  explicit QueryResult(bool is_ids_only = false) : is_ids_only_(is_ids_only) {}

  /// The entity in the tree, inserted where it is missing. The reference is valid until the next
  /// insertion. Needs an ID of an entity (checked).
  EntityResult& add_entity(const MemoryId& entity);

  /// Unites this with the answer of another memory to the same query; see EntityResult::add.
  /// Errors: kInvalidArgument where one has data and the other only IDs.
  Status merge(QueryResult other);

  [[nodiscard]] const std::vector<MemoryResult>& memories() const& { return memories_; }
  void memories() && = delete;

  /// All entities, in the order of names; valid as long as the tree does not change.
  [[nodiscard]] std::vector<const EntityResult*> entities() const&;
  /// The entities of a temporary would dangle in a loop.
  void entities() && = delete;

  /// The element at an ID; null where there is none. The ID may also be deeper than the element.
  [[nodiscard]] const EntityResult* find_entity(const MemoryId& id) const;
  [[nodiscard]] const SnapshotResult* find_snapshot(const MemoryId& id) const;
  [[nodiscard]] const InstanceResult* find_instance(const MemoryId& id) const;

  /// True where the tree has anything at this ID, at any level.
  [[nodiscard]] bool contains(const MemoryId& id) const;

  /// The deepest IDs in order: instances; snapshots without instances; entities without snapshots.
  [[nodiscard]] std::vector<MemoryId> ids() const;

  [[nodiscard]] bool is_ids_only() const { return is_ids_only_; }
  [[nodiscard]] size_t snapshot_count() const;

  /// The size of the plain values, as Snapshot::raw_bytes counts them. Unit: bytes.
  [[nodiscard]] size_t size_bytes() const;

  /// Returns {"ids_only", "entities": [{"id", "snapshots": [{"time", "source", ...,
  /// "instances"}]}]}. These are seven levels around the data, which the binary and JSON forms must
  /// be told (idf::kContainerDepth).
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<QueryResult> from_data(const idf::Data& data);

  friend bool operator==(const QueryResult&, const QueryResult&) = default;

 private:
  std::vector<MemoryResult> memories_;
  bool is_ids_only_ = false;
};

}  // namespace engram::ltm
