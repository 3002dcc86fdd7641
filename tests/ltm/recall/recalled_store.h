// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/recall/recall.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// Keeps the bytes of the value as its code; adds "decoded" so that answers tell.
class BytesEncoder final : public Encoder {
 public:
  Result<std::vector<Latent>> encode(std::span<const idf::Data> values) override {
    std::vector<Latent> latents;
    for (const idf::Data& value : values) {
      ENGRAM_ASSIGN_OR_RETURN(auto bytes, idf::encode(value));
      latents.push_back({Buffer::take(std::move(bytes)), {}});
    }
    return latents;
  }

  Result<std::vector<idf::Data>> decode(std::span<const Latent> latents) override {
    std::vector<idf::Data> values;
    for (const Latent& latent : latents) {
      ENGRAM_ASSIGN_OR_RETURN(idf::Data value, idf::decode(latent.code));
      if (idf::Dict* dict = value.get_if<idf::Dict>()) dict->set("decoded", true);
      values.push_back(std::move(value));
    }
    return values;
  }
};

/// Adds the number of steps and the length of the history to the last value.
class CountingPredictor final : public Predictor {
 public:
  explicit CountingPredictor(std::optional<MemoryId> condition = {})
      : condition_(std::move(condition)) {}

  [[nodiscard]] std::string_view name() const override { return "counting"; }
  [[nodiscard]] Duration step() const override { return std::chrono::milliseconds(200); }
  [[nodiscard]] size_t context() const override { return 3; }

  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    const auto history = past.values;
    std::vector<Prediction> predictions;
    for (int step = 1; step <= steps; ++step) {
      idf::Data value = history.back();
      value.get_if<idf::Dict>()->set("step", step);
      value.get_if<idf::Dict>()->set("history", static_cast<int32_t>(history.size()));
      if (!past.conditions.empty())
        value.get_if<idf::Dict>()->set("conditions",
                                       idf::List(past.conditions.begin(), past.conditions.end()));
      if (!past.plan.empty())
        value.get_if<idf::Dict>()->set("plan", idf::List(past.plan.begin(), past.plan.end()));
      const double number_mse = past.conditions.empty() ? 0.5 : 0.25;
      predictions.push_back({std::move(value),
                             {{static_cast<double>(step), number_mse},
                              {static_cast<double>(3 * step), 2 * number_mse}}});
    }
    return predictions;
  }

  [[nodiscard]] std::optional<MemoryId> condition() const override { return condition_; }

 private:
  std::optional<MemoryId> condition_;
};

/// A store of two entities, whose models are found out by what they answer.
class RecalledStore : public ::testing::Test {
 protected:
  /// Ten recorded snapshots; `latents` of them with latents of model 1; `dropped` without the rest.
  void make_store(int64_t latents, bool is_dropped) {
    store_ = scratch_ / "store";
    ASSERT_OK(create_store(store_));
    {
      const auto writer = *StoreWriter::open(store_, {});
      for (int64_t i = 0; i < 10; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
      ASSERT_OK(writer->append({packed_example(0, example_entity("other"))}, nullptr));
      ASSERT_OK(writer->seal());
    }
    if (latents == 0) return;
    std::vector<LatentSnapshot> snapshots;
    for (int64_t i = 0; i < latents; ++i) {
      const idf::Data value = example_snapshot(example_entity(), i).instances[0].data;
      Latent latent = BytesEncoder().encode({&value, 1})->front();
      snapshots.push_back(
          {example_time(i), 1, {{std::move(latent), example_metadata(i), {2.0, 0.25}}}});
    }
    const auto model = temporary_file(store_, ".model");
    ASSERT_OK(replace_file(*model, as_bytes("weights")));
    ASSERT_OK(publish_model(store_, example_entity(), 1, *model, snapshots));
    if (is_dropped) {
      ASSERT_OK(drop_recorded(store_, example_entity(), {}));
    }
  }

  ModelLoader loader() {
    return [this](const std::filesystem::path& file) -> Result<LoadedModel> {
      ++loaded_;
      EXPECT_TRUE(std::filesystem::exists(file));
      return LoadedModel{std::make_unique<BytesEncoder>(),
                         std::make_unique<CountingPredictor>(condition_)};
    };
  }

  Recall open(ModelLoader loader) {
    return {*StoreReader::open(store_), std::move(loader), nullptr, {}};
  }

  static Query ask(const std::string& selector) {
    return *Query::parse("Vision/RGB/head/cam @ " + selector);
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
  int loaded_ = 0;
  std::optional<MemoryId> condition_;  ///< Of the predictor.
};

}  // namespace engram::ltm
