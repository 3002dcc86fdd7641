// SPDX-License-Identifier: Apache-2.0
#include "encoders/model_records.h"

#include <type_traits>
#include <utility>

#include "encoders/model_vectors.h"
#include "ltm/idf/binary.h"

namespace engram::encoders {

namespace {

constexpr const char* kNumberCodecPath = "/codec/numbers";

std::string image_codec_path(size_t image) {
  return fmt::format("/codec/image{}", image);
}

std::string references_path(size_t image) {
  return fmt::format("/codec/references{}", image);
}

Status write_bytes(h5::File& file, const std::string& path, const std::vector<std::byte>& bytes) {
  const auto* first = reinterpret_cast<const uint8_t*>(bytes.data());
  return write_vector(file, path, std::vector<uint8_t>(first, first + bytes.size()));
}

}  // namespace

Status write_codec(h5::File& file, const LatentBlockCodec& codec) {
  ENGRAM_RETURN_IF_ERROR(file.make_group("/codec"));
  for (size_t i = 0; i < codec.chain.images.size(); ++i)
    ENGRAM_RETURN_IF_ERROR(
        write_bytes(file, image_codec_path(i), codec.chain.images[i].model().to_bytes()));
  for (size_t i = 0; i < codec.chain.references.size(); ++i)
    if (!codec.chain.references[i].empty())
      ENGRAM_RETURN_IF_ERROR(
          write_bytes(file, references_path(i), to_bytes(codec.chain.references[i])));
  if (!codec.chain.numbers) return {};
  return write_bytes(file, kNumberCodecPath, codec.chain.numbers->model().to_bytes());
}

Status read_codec(const h5::File& file, const NetworkShape& shape, LatentBlockCodec& codec) {
  for (size_t i = 0; i < shape.images.size() && shape.sizes.width > 0; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, read_vector<uint8_t>(file, image_codec_path(i)));
    ENGRAM_ASSIGN_OR_RETURN(
        LatentModel model,
        LatentModel::from_bytes(std::as_bytes(std::span(bytes)), shape.grids(i)));
    codec.chain.images.emplace_back(std::move(model));
  }
  codec.chain.references.resize(codec.chain.frames.size());
  for (size_t i = 0; i < codec.chain.frames.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_references, file.exists(references_path(i)));
    if (!has_references) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, read_vector<uint8_t>(file, references_path(i)));
    ENGRAM_ASSIGN_OR_RETURN(codec.chain.references[i],
                            references_from(std::as_bytes(std::span(bytes))));
  }
  if (shape.numbers == 0) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, read_vector<uint8_t>(file, kNumberCodecPath));
  ENGRAM_ASSIGN_OR_RETURN(NumberModel model,
                          NumberModel::from_bytes(std::as_bytes(std::span(bytes))));
  if (model.count() != static_cast<size_t>(shape.numbers))
    return data_loss("found a codec of {} numbers, needs {}", model.count(), shape.numbers);
  codec.chain.numbers.emplace(std::move(model));
  return {};
}

Status write_condition(h5::File& file, const Condition& condition) {
  ENGRAM_RETURN_IF_ERROR(file.make_group("/condition"));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute("/condition", "entity", std::string_view(condition.entity)));
  ENGRAM_ASSIGN_OR_RETURN(const auto layout, idf::encode(condition.plan.layout().to_data()));
  const auto* bytes = reinterpret_cast<const uint8_t*>(layout.data());
  ENGRAM_RETURN_IF_ERROR(
      write_vector(file, "/condition/layout", std::vector<uint8_t>(bytes, bytes + layout.size())));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/condition/mean", condition.mean));
  return write_vector(file, "/condition/deviation", condition.deviation);
}

Result<Condition> read_condition(const h5::File& file, int count) {
  Condition condition;
  ENGRAM_ASSIGN_OR_RETURN(condition.entity, file.string_attribute("/condition", "entity"));
  if (const auto id = ltm::MemoryId::parse(condition.entity); !id.ok())
    return data_loss("found a condition of '{}', needs the ID of an entity", condition.entity);
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, read_vector<uint8_t>(file, "/condition/layout"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data, idf::decode(Buffer::take(bytes)));
  ENGRAM_ASSIGN_OR_RETURN(idf::Layout layout, idf::Layout::from_data(data));
  ENGRAM_ASSIGN_OR_RETURN(condition.plan, TensorPlan::create(std::move(layout)));
  ENGRAM_ASSIGN_OR_RETURN(condition.mean, read_vector<double>(file, "/condition/mean"));
  ENGRAM_ASSIGN_OR_RETURN(condition.deviation, read_vector<double>(file, "/condition/deviation"));
  const auto needed = static_cast<size_t>(count);
  if (condition.plan.number_count() != needed || condition.mean.size() != needed ||
      condition.deviation.size() != needed)
    return data_loss("found conditions of {} numbers, needs {}", condition.plan.number_count(),
                     needed);
  return condition;
}

namespace {

/// Visits the numbers of one kind of error in their order in the file.
template <typename Calibration, typename Visit>
void for_each_number(Calibration& errors, Visit visit) {
  visit(errors.min_change);
  visit(errors.exponent);
  visit(errors.expected_per_scale);
  visit(errors.bound_per_scale);
  visit(errors.mean);
  visit(errors.measured);
}

/// Visits the numbers of a record: for each horizon its gates, then the errors of images and of
/// numbers.
template <typename Record, typename Visit>
void for_each_number_of(Record& record, Visit visit) {
  for (size_t i = 0; i < kMeasuredHorizons; ++i) {
    visit(record.image_gates[i]);
    visit(record.motion_gates[i]);
    visit(record.number_gates[i]);
    for_each_number(record.errors[i].images, visit);
    for_each_number(record.errors[i].numbers, visit);
  }
}

constexpr size_t kNumbersOfHorizon = 3 + 2 * 6;

}  // namespace

// All numbers share one dataset, because a dataset costs more bytes than its few numbers.
Status write_prediction(h5::File& file, const std::string& group, const PredictionRecord& record) {
  std::vector<double> numbers;
  for_each_number_of(record,
                     [&](const auto& number) { numbers.push_back(static_cast<double>(number)); });
  ENGRAM_RETURN_IF_ERROR(write_vector(file, group + "/horizons", numbers));
  return file.write_attribute(group, "step_ns", static_cast<int64_t>(record.step.count()));
}

Result<PredictionRecord> read_prediction(const h5::File& file, const std::string& group) {
  constexpr size_t kNumbers = kNumbersOfHorizon * kMeasuredHorizons;
  ENGRAM_ASSIGN_OR_RETURN(const auto numbers, read_vector<double>(file, group + "/horizons"));
  if (numbers.size() != kNumbers)
    return data_loss("{}: found {} numbers, needs {}", group, numbers.size(), kNumbers);
  PredictionRecord record;
  size_t at = 0;
  for_each_number_of(record, [&]<typename T>(T& number) {
    constexpr double kMax = 1e15;
    const double value = numbers[at++];
    if constexpr (std::is_integral_v<T>)
      number = value >= 0 && value <= kMax ? static_cast<T>(value) : -1;
    else
      number = value;
  });
  for (const auto* gates : {&record.image_gates, &record.motion_gates, &record.number_gates})
    for (const double gate : *gates)
      if (!(gate >= 0 && gate <= 1))
        return data_loss("{}: found a gate of {}, needs 0 to 1", group, gate);
  for (const HorizonErrors& errors : record.errors)
    for (const ErrorCalibration* kind : {&errors.images, &errors.numbers})
      if (const Status valid = kind->validate(); !valid.ok()) return valid.with_context(group);
  ENGRAM_ASSIGN_OR_RETURN(const int64_t step, file.int_attribute(group, "step_ns"));
  record.step = Duration(step);
  return record;
}

}  // namespace engram::encoders
