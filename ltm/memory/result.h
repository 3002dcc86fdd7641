// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/member_prediction.h"
#include "ltm/memory/snapshot.h"
#include "ltm/memory/source.h"

namespace engram::ltm {

/// How likely the real error of a prediction is at most its bound.
inline constexpr double kBoundProbability = 0.9;

/// One datum of an answer.
struct InstanceResult {
  int32_t index = 0;
  idf::Data data;             ///< None where only IDs were asked for.
  InstanceMetadata metadata;  ///< As made by default where only IDs were asked for.
  /// Measured (reconstructed) or expected (predicted) error; nothing where it was recorded.
  std::optional<MeasuredError> error = {};
  /// What the error of a prediction stays within, with kBoundProbability; not a number where that
  /// is not known. Nothing unless predicted.
  std::optional<MeasuredError> bound = {};
  /// How each tensor member was predicted, in the order of the value's layout; empty unless
  /// predicted by a choice of engines. `error` and `bound` are the means of what counts here.
  std::vector<MemberPrediction> members = {};

  friend bool operator==(const InstanceResult&, const InstanceResult&) = default;
};

/// One moment of an entity in an answer. Never of two sources at once.
struct SnapshotResult {
  Time time{};
  Source source = Source::kRecorded;
  /// "Vision/RGB/head/cam v1" where a model decoded or predicted it, else empty.
  std::string model;
  /// Name of the engine that predicted it; "copy-last" where nothing but copies is in it, "mixed"
  /// where its members were predicted by several (see InstanceResult::members). Empty unless
  /// predicted.
  std::string predictor;
  /// From the last known snapshot; zero unless predicted.
  Duration horizon{};
  /// Entity whose planned numbers the prediction was told; empty without a plan.
  std::string plan{};
  std::vector<InstanceResult> instances;  ///< In the order of their indices.

  /// Null where there is no such instance.
  [[nodiscard]] const InstanceResult* find(int32_t index) const;

  /// Adds an instance behind the others, with the next index.
  void append(idf::Data data, const InstanceMetadata& metadata,
              std::optional<MeasuredError> error = {}, std::optional<MeasuredError> bound = {});

  friend bool operator==(const SnapshotResult&, const SnapshotResult&) = default;
};

struct EntityResult {
  MemoryId id;
  std::vector<SnapshotResult> snapshots;  ///< In the order of time; may be empty.

  /// Null where there is no such snapshot. Complexity: O(log n).
  [[nodiscard]] const SnapshotResult* find(Time time) const;

  /// Puts a snapshot where its time belongs. Of two with the same time the one that is closer to
  /// the truth stays (see Source); two of the same source are united by instance, the ones that
  /// were here first stay. Complexity: O(1) in the order of time, else O(n).
  void add(SnapshotResult snapshot);

  friend bool operator==(const EntityResult&, const EntityResult&) = default;
};

/// A segment or a memory in an answer, and what it has below.
template <typename Below>
struct NameResult {
  std::string name;
  std::vector<Below> below;  ///< In the order of names; never empty.

  friend bool operator==(const NameResult&, const NameResult&) = default;
};

using ProviderSegmentResult = NameResult<EntityResult>;
using CoreSegmentResult = NameResult<ProviderSegmentResult>;
using MemoryResult = NameResult<CoreSegmentResult>;

/// The answer to a query: a tree of the six levels, memory to instance, each in its order.
/// Entities that match and have no such snapshot are in it too.
///
/// Threading: immutable but for add_entity, merge and assignment.
/// Source: docs/query.md.
class QueryResult {
 public:
  explicit QueryResult(bool is_ids_only = false) : is_ids_only_(is_ids_only) {}

  /// The entity's place in the tree, made where it is missing. Valid until the next entity is
  /// made. Needs an ID of an entity (checked).
  EntityResult& add_entity(const MemoryId& entity);

  /// Takes in what another memory answered to the same query; see EntityResult::add.
  /// Errors: kInvalidArgument where one has data and the other only IDs.
  Status merge(QueryResult other);

  [[nodiscard]] const std::vector<MemoryResult>& memories() const& { return memories_; }
  void memories() && = delete;

  /// All entities, in the order of names; valid as long as the tree does not change.
  [[nodiscard]] std::vector<const EntityResult*> entities() const&;
  /// The entities of a temporary would dangle in a loop.
  void entities() && = delete;

  /// What lies at an ID; null where there is nothing. Each takes its own level or a deeper one.
  [[nodiscard]] const EntityResult* find_entity(const MemoryId& id) const;
  [[nodiscard]] const SnapshotResult* find_snapshot(const MemoryId& id) const;
  [[nodiscard]] const InstanceResult* find_instance(const MemoryId& id) const;

  /// True where the tree has anything at this ID, of whatever level.
  [[nodiscard]] bool contains(const MemoryId& id) const;

  /// The deepest IDs in order: instances; snapshots without any; entities without any.
  [[nodiscard]] std::vector<MemoryId> ids() const;

  [[nodiscard]] bool is_ids_only() const { return is_ids_only_; }
  [[nodiscard]] size_t snapshot_count() const;

  /// Bytes of the plain values, as Snapshot::raw_bytes counts them.
  [[nodiscard]] size_t size_bytes() const;

  /// {"ids_only", "entities": [{"id", "snapshots": [{"time", "source", ..., "instances"}]}]}: seven
  /// levels around the data, which the binary and JSON forms must be told (idf::kContainerDepth).
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
