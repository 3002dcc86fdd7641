// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/answers/lived_store.h"

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_writer.h"
#include "ltm/store/temporary_file.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::testing {

namespace {

using ltm::MemoryId;

constexpr int64_t kStored = 60;  ///< Snapshots of entities with a model, before today.

MemoryId id(const char* text) {
  return *MemoryId::parse(text);
}

/// Keeps values as their bytes; a code that is no value is damaged.
class BytesEncoder final : public ltm::Encoder {
 public:
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values) override {
    std::vector<ltm::Latent> latents;
    for (const idf::Data& value : values) {
      ENGRAM_ASSIGN_OR_RETURN(auto bytes, idf::encode(value));
      latents.push_back({Buffer::take(std::move(bytes)), {}});
    }
    return latents;
  }

  Result<std::vector<idf::Data>> decode(std::span<const ltm::Latent> latents) override {
    std::vector<idf::Data> values;
    for (const ltm::Latent& latent : latents) {
      auto value = idf::decode(latent.code);
      if (!value.ok()) return data_loss("a code is no value");
      values.push_back(*std::move(value));
    }
    return values;
  }
};

/// Goes on from the last value in a straight line; with conditions, half as fast; with a plan,
/// also by the planned shoulders.
class LinePredictor final : public ltm::Predictor {
 public:
  explicit LinePredictor(std::optional<MemoryId> condition) : condition_(std::move(condition)) {}

  [[nodiscard]] std::string_view name() const override { return "deep"; }
  [[nodiscard]] Duration step() const override { return std::chrono::milliseconds(200); }
  [[nodiscard]] size_t context() const override { return 3; }
  [[nodiscard]] std::optional<MemoryId> condition() const override { return condition_; }

  Result<std::vector<ltm::Prediction>> predict(const ltm::Past& past, int steps) override {
    const double speed = past.conditions.empty() ? 0.25 : 0.125;
    std::vector<ltm::Prediction> predictions;
    for (int step = 1; step <= steps; ++step) {
      idf::Data value = past.values.back();
      double x = *past.values.back().at("x")->get_if<double>() + speed * step;
      for (const idf::Data& planned : past.plan) x += *planned.at("shoulder")->get_if<double>();
      value.get_if<idf::Dict>()->set("x", x);
      predictions.push_back({std::move(value), {{0.0, 0.01 * step}, {0.0, 0.04 * step}}});
    }
    return predictions;
  }

 private:
  std::optional<MemoryId> condition_;
};

/// Moves to and fro in a way that no straight line tells.
ltm::Snapshot snapshot_of(const MemoryId& entity, int64_t index) {
  ltm::Snapshot made = ltm::example_snapshot(entity, index);
  const auto phase = static_cast<double>((index * index) % 11);
  made.instances[0].data.get_if<idf::Dict>()->set("x", 0.25 * static_cast<double>(index) + phase);
  return made;
}

/// Two arms, each with its own numbers.
ltm::Snapshot joints_of(int64_t index) {
  ltm::Snapshot made{id("Robot/State/arm/joints"), ltm::example_time(index), {}};
  for (const double speed : {0.01, -0.02}) {
    idf::Dict value{{"shoulder", speed * static_cast<double>(index)}, {"is_moving", true}};
    made.instances.push_back({std::move(value), ltm::example_metadata(index)});
  }
  return made;
}

Result<ltm::LatentSnapshot> latent_of(const ltm::Snapshot& snapshot, bool is_damaged) {
  ENGRAM_ASSIGN_OR_RETURN(auto latents, BytesEncoder().encode({&snapshot.instances[0].data, 1}));
  if (is_damaged) latents[0].code = Buffer::take(std::vector<uint8_t>{0xff, 0xfe, 0x01});
  return ltm::LatentSnapshot{
      snapshot.time, 1, {{std::move(latents[0]), snapshot.instances[0].metadata, {2.0, 0.25}}}};
}

/// Latents of the snapshots before `end`; all of which but the last of them are `damaged`.
Status publish(const std::filesystem::path& store, const MemoryId& entity, int64_t end,
               bool is_damaged) {
  std::vector<ltm::LatentSnapshot> latents;
  for (int64_t i = 0; i < end; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(latents.emplace_back(),
                            latent_of(snapshot_of(entity, i), is_damaged && i + 1 < end));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto file, ltm::temporary_file(store, ".model"));
  ENGRAM_RETURN_IF_ERROR(replace_file(file, as_bytes(entity.to_string())));
  return ltm::publish_model(store, entity, 1, file, latents);
}

TimeSet times_of(int64_t first, int64_t last) {
  TimeSet times;
  for (int64_t i = first; i <= last; ++i) times.insert(ltm::example_time(i));
  return times;
}

}  // namespace

Status make_lived_store(const std::filesystem::path& store) {
  ENGRAM_RETURN_IF_ERROR(ltm::create_store(store));
  const auto cam = id("Vision/RGB/head/cam"), damaged = id("Vision/RGB/head/damaged"),
             led = id("Vision/RGB/head/led"), broken = id("Robot/State/arm/broken"),
             forgotten = id("Robot/State/arm/forgotten");
  {
    ENGRAM_ASSIGN_OR_RETURN(const auto writer, ltm::StoreWriter::open(store, {}));
    const auto append = [&](const ltm::Snapshot& snapshot) {
      return writer->append({ltm::pack_snapshot(snapshot)}, nullptr);
    };
    ENGRAM_RETURN_IF_ERROR(append(ltm::example_snapshot(id("Objects/Things/kitchen/cup"), -5000)));
    for (int64_t i = 0; i < kStored; ++i) {
      for (const MemoryId& entity : {cam, damaged, led, broken})
        ENGRAM_RETURN_IF_ERROR(append(snapshot_of(entity, i)));
      ENGRAM_RETURN_IF_ERROR(append(joints_of(i)));
      if (i < 30) ENGRAM_RETURN_IF_ERROR(append(ltm::example_snapshot(forgotten, i)));
    }
    ENGRAM_RETURN_IF_ERROR(writer->seal());
  }
  ENGRAM_RETURN_IF_ERROR(publish(store, cam, 40, false));
  ENGRAM_RETURN_IF_ERROR(publish(store, damaged, 40, true));
  ENGRAM_RETURN_IF_ERROR(publish(store, led, 40, false));
  ENGRAM_RETURN_IF_ERROR(publish(store, broken, kStored, true));
  ENGRAM_RETURN_IF_ERROR(ltm::drop_recorded(store, cam, times_of(30, 39)).status());
  ENGRAM_RETURN_IF_ERROR(ltm::drop_recorded(store, damaged, {}).status());
  ENGRAM_RETURN_IF_ERROR(ltm::drop_recorded(store, broken, {}).status());
  return ltm::forget_snapshots(store, {{forgotten, times_of(10, 19)}}).status();
}

std::vector<ltm::Commit> commits_of_today() {
  std::vector<ltm::Commit> commits;
  for (int64_t i = kStored; i < kStored + 20; ++i) {
    ltm::Commit commit;
    commit.updates.push_back(snapshot_of(id("Vision/RGB/head/cam"), i));
    commit.updates.push_back(snapshot_of(id("Vision/RGB/head/led"), i));
    commit.updates.push_back(joints_of(i));
    if (i % 8 == 0)
      commit.updates.push_back({id("Speech/Commands/human/text"),
                                ltm::example_time(i),
                                {{idf::Data("number " + std::to_string(i)), {}}}});
    commits.push_back(std::move(commit));
  }
  commits.push_back({{ltm::example_snapshot(id("Objects/Things/kitchen/cup"), kStored + 30)}});
  return commits;
}

ltm::ModelLoader lived_models() {
  return [](const std::filesystem::path& file) -> Result<ltm::LoadedModel> {
    std::optional<MemoryId> condition;
    if (file.filename().string().find(".led.") != std::string::npos)
      condition = id("Robot/State/arm/broken");
    if (file.filename().string().find(".cam.") != std::string::npos)
      condition = id("Robot/State/arm/joints");
    return ltm::LoadedModel{std::make_unique<BytesEncoder>(),
                            std::make_unique<LinePredictor>(std::move(condition))};
  };
}

}  // namespace engram::testing
