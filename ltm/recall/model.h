// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/memory/result.h"
#include "ltm/store/latent.h"

namespace engram::ltm {

/// Turns values of one entity into latents and back.
///
/// Threading: one thread.
/// Source: docs/design.md, section 5.
class Encoder {
 public:
  virtual ~Encoder() = default;

  /// One latent per value, in order. The values are consecutive snapshots of one recording and may
  /// be coded as blocks: then latents share their bytes, and their places tell which is which.
  /// Errors: kInvalidArgument where a value has another layout than the model.
  virtual Result<std::vector<Latent>> encode(std::span<const idf::Data> values) = 0;

  /// One value per latent, in order. Exactly what a query answers. Safe on hostile bytes and
  /// places. Any latents of the model, also some of a block; those of one block come in its order,
  /// in this call or in later ones, so that keeping the last block is enough to decode each once.
  /// Errors: kDataLoss where a latent is not of this model.
  virtual Result<std::vector<idf::Data>> decode(std::span<const Latent> latents) = 0;

  /// One code per latent, in order: some numbers, as many for each, whose Euclidean distance is
  /// small where images look alike. Images that are kept as latents are not decoded.
  /// Errors: as decode; kFailedPrecondition where the model has no codes.
  virtual Result<std::vector<std::vector<float>>> global_codes(
      std::span<const Latent> /*latents*/) {
    return failed_precondition("this encoder has no global codes");
  }

  /// The code of a value, to look for what resembles it.
  /// Errors: kInvalidArgument where it has another layout; kFailedPrecondition as above.
  virtual Result<std::vector<float>> global_code(const idf::Data& /*value*/) {
    return failed_precondition("this encoder has no global codes");
  }
};

/// What a prediction starts from.
struct Past {
  Past() = default;
  // Most predictions start from values alone.
  // NOLINTBEGIN(google-explicit-constructor)
  Past(std::span<const idf::Data> past, std::span<const idf::Data> known = {})
      : values(past), conditions(known) {}
  Past(const std::vector<idf::Data>& past) : values(past) {}
  // NOLINTEND(google-explicit-constructor)

  std::span<const idf::Data> values;  ///< Of the entity, oldest first.
  /// Of Predictor::condition(), one for each of `values`: the last at or before its time. Empty
  /// where one is missing.
  std::span<const idf::Data> conditions;
  /// The same as planned for 1, 2, ... steps after the last of `values`; beyond its end a plan
  /// stands still. Empty without a plan; nothing without `conditions`.
  std::span<const idf::Data> plan;
};

/// What a prediction was told beside the past of its entity.
enum class Told {
  kValues,      ///< Nothing.
  kConditions,  ///< The past of Predictor::condition().
  kPlan,        ///< And what is planned of it.
};

/// How wrong a prediction may be, told before the fact. Not a number where it is not known.
struct ErrorEstimate {
  MeasuredError expected;  ///< The mean.
  MeasuredError bound;     ///< The real one is at most that, with kBoundProbability.

  friend bool operator==(const ErrorEstimate&, const ErrorEstimate&) = default;
};

struct Prediction {
  idf::Data value;
  ErrorEstimate error;
};

/// What is known of predictions so many steps ahead from data that the model was not trained on.
struct HorizonRecord {
  int steps = 0;
  uint64_t predictions = 0;  ///< That it was measured on.
  MeasuredError mean;        ///< Their mean error.
};

/// Continues the past of one entity.
///
/// Threading: one thread.
class Predictor {
 public:
  virtual ~Predictor() = default;

  /// "copy-last" or "deep": what an answer names as its engine.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Time between two snapshots that it was trained on; zero where any will do.
  [[nodiscard]] virtual Duration step() const = 0;

  /// Past snapshots that it wants to see; fewer are accepted, at least one is needed.
  [[nodiscard]] virtual size_t context() const = 0;

  /// Another entity whose past makes predictions better; nothing where there is none.
  [[nodiscard]] virtual std::optional<MemoryId> condition() const { return std::nullopt; }

  /// The values 1..`steps` steps after the last of `past`, and how wrong they may be.
  /// Errors: kInvalidArgument where a value, or a planned one, has another layout than the model's.
  virtual Result<std::vector<Prediction>> predict(const Past& past, int steps) = 0;

  /// By steps; empty where nothing was measured.
  [[nodiscard]] virtual std::vector<HorizonRecord> records(Told /*told*/) const { return {}; }
};

/// The parts of one model file.
struct LoadedModel {
  std::unique_ptr<Encoder> encoder;
  std::unique_ptr<Predictor> predictor;
  /// Copies the last value, and knows how wrong that was on the same data; may be null.
  std::unique_ptr<Predictor> copy_last = {};
};

/// Opens a model file. Given from above, so that recall needs no learning library.
using ModelLoader = std::function<Result<LoadedModel>(const std::filesystem::path&)>;

/// A predictor that answers with the last value: the floor of every other one.
[[nodiscard]] std::unique_ptr<Predictor> make_copy_last_predictor();

}  // namespace engram::ltm
