// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ltm/memory/query.h"
#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Where a value that a query answered with comes from.
enum class Source { kRecorded, kReconstructed, kPredicted };

/// "recorded", "reconstructed", "predicted".
[[nodiscard]] std::string_view to_string(Source source);

/// One snapshot of an answer. Never recorded and something else at once: `source` says which.
struct RecalledSnapshot {
  Snapshot snapshot;
  Source source = Source::kRecorded;
  /// "Vision/RGB/head/cam v1" where a model decoded or predicted it, else empty.
  std::string model;
  /// Name of the predictor; empty unless predicted.
  std::string predictor;
  /// Measured (reconstructed) or expected (predicted) error per instance; empty if recorded.
  std::vector<MeasuredError> errors;
  /// From the last known snapshot; zero unless predicted.
  Duration horizon{};
};

struct RecalledEntity {
  MemoryId id;
  std::vector<RecalledSnapshot> snapshots;  ///< In the order of time.
};

struct QueryResult {
  std::vector<RecalledEntity> entities;  ///< In the order of names; entities without answer too.
};

/// Answers queries from a store: about the past from whatever form holds it, about the future by
/// prediction.
///
/// Threading: one thread.
class Recall {
 public:
  /// Which form answers where a snapshot has both.
  enum class Prefer { kRecorded, kLatent };

  struct Options {
    Prefer prefer = Prefer::kRecorded;
    /// Longest prediction, in steps of the predictor.
    int max_steps = 50;
  };

  /// Without a `loader` latents cannot be decoded and predictions are copies of the last snapshot.
  Recall(std::unique_ptr<StoreReader> store, ModelLoader loader);
  ~Recall();

  [[nodiscard]] StoreReader& store();

  /// Errors: kNotFound where no entity matches; kInvalidArgument where a prediction is asked too
  /// far ahead; kFailedPrecondition where a latent needs a model and there is no loader; kDataLoss.
  Result<QueryResult> query(const Query& query, const Options& options);
  Result<QueryResult> query(const Query& query) { return this->query(query, Options{}); }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
