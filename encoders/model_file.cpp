// SPDX-License-Identifier: Apache-2.0
#include "encoders/model_file.h"

#include <cmath>
#include <limits>

#include "encoders/deep_model_file.h"
#include "ltm/h5/h5.h"
#include "ltm/idf/binary.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr std::string_view kFormat = "engram model";
constexpr int64_t kMaxWidth = 512;
constexpr int64_t kMaxLatentChannels = 256;
constexpr uint64_t kMaxBytes = uint64_t{1} << 30;
/// Decoded grey levels may differ by this much between machines.
constexpr double kImageTolerance = 1.0;
/// Decoded numbers may, in standard deviations.
constexpr double kNumberTolerance = 1e-2;

template <typename T>
constexpr h5::Type kTypeOf = [] {
  if constexpr (std::is_same_v<T, int8_t>)
    return h5::Type::kInt8;
  else if constexpr (std::is_same_v<T, uint8_t>)
    return h5::Type::kUInt8;
  else if constexpr (std::is_same_v<T, uint16_t>)
    return h5::Type::kUInt16;
  else if constexpr (std::is_same_v<T, int32_t>)
    return h5::Type::kInt32;
  else if constexpr (std::is_same_v<T, int64_t>)
    return h5::Type::kInt64;
  else if constexpr (std::is_same_v<T, float>)
    return h5::Type::kFloat32;
  else {
    static_assert(std::is_same_v<T, double>);
    return h5::Type::kFloat64;
  }
}();

template <typename T>
Status write_vector(h5::File& file, const std::string& path, const std::vector<T>& values) {
  const uint64_t shape = values.size();
  return file.write(path, kTypeOf<T>, {&shape, 1}, std::as_bytes(std::span(values)),
                    values.empty() ? h5::Storage::kContiguous : h5::Storage::kCompressed);
}

template <typename T>
Result<std::vector<T>> read_vector(const h5::File& file, const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file.read(path, kTypeOf<T>, kMaxBytes));
  return h5::as_vector<T>(bytes);
}

/// Weights of a module in the order of their names, by the way they are stored.
struct Weights {
  std::vector<int8_t> bytes;    ///< Matrices and convolutions.
  std::vector<float> scales;    ///< One per output channel of those.
  std::vector<uint8_t> pixels;  ///< Backgrounds.
  std::vector<float> floats;    ///< Everything else.
};

/// Calls visit(name, tensor, is_buffer) for all tensors of both networks.
template <typename Visit>
Status for_each_tensor(DeepModel& model, Visit visit) {
  for (torch::nn::Module* module : {static_cast<torch::nn::Module*>(model.autoencoder.get()),
                                    static_cast<torch::nn::Module*>(model.dynamics.get())}) {
    for (auto& item : module->named_parameters())
      ENGRAM_RETURN_IF_ERROR(visit(item.key(), item.value(), false));
    for (auto& item : module->named_buffers())
      ENGRAM_RETURN_IF_ERROR(visit(item.key(), item.value(), true));
  }
  return {};
}

std::vector<float> floats_of(const Tensor& tensor) {
  const Tensor rows = tensor.detach().to(torch::kFloat32).contiguous();
  return {rows.data_ptr<float>(), rows.data_ptr<float>() + rows.numel()};
}

void append_bytes(const Tensor& tensor, Weights& weights) {
  const std::vector<float> values = floats_of(tensor);
  const size_t row_size = values.size() / static_cast<size_t>(tensor.size(0));
  for (size_t first = 0; first < values.size(); first += row_size) {
    float largest = 0;
    for (size_t i = 0; i < row_size; ++i) largest = std::max(largest, std::abs(values[first + i]));
    const float scale = weight_scale(largest);
    weights.scales.push_back(scale);
    for (size_t i = 0; i < row_size; ++i)
      weights.bytes.push_back(static_cast<int8_t>(std::lround(values[first + i] / scale)));
  }
}

Weights collect(DeepModel& model) {
  torch::NoGradGuard no_grad;
  Weights weights;
  const Status status =
      for_each_tensor(model, [&](const auto& name, Tensor& tensor, bool is_buffer) {
        switch (kept_as(name, tensor, is_buffer)) {
          case Kept::kBytes:
            append_bytes(tensor, weights);
            break;
          case Kept::kPixels:
            for (const float value : floats_of(tensor))
              weights.pixels.push_back(static_cast<uint8_t>(std::lround(value * kGreyLevels)));
            break;
          case Kept::kFloats:
            for (const float value : floats_of(tensor)) weights.floats.push_back(value);
            break;
        }
        return Status();
      });
  ENGRAM_CHECK(status.ok(), "{}", status.message());
  return weights;
}

/// Takes the next values of each kind, and checks that there are enough.
class WeightReader {
 public:
  explicit WeightReader(const Weights& weights) : weights_(weights) {}

  Status read(const std::string& name, Tensor& tensor, bool is_buffer) {
    const auto count = static_cast<size_t>(tensor.numel());
    std::vector<float> values(count);
    switch (kept_as(name, tensor, is_buffer)) {
      case Kept::kBytes: {
        const auto rows = static_cast<size_t>(tensor.size(0));
        if (weights_.bytes.size() - bytes_ < count || weights_.scales.size() - scales_ < rows)
          return too_few(name);
        for (size_t i = 0; i < count; ++i)
          values[i] = static_cast<float>(weights_.bytes[bytes_ + i]) *
                      weights_.scales[scales_ + i / (count / rows)];
        bytes_ += count;
        scales_ += rows;
        break;
      }
      case Kept::kPixels:
        if (weights_.pixels.size() - pixels_ < count) return too_few(name);
        for (size_t i = 0; i < count; ++i)
          values[i] = static_cast<float>(weights_.pixels[pixels_ + i] / kGreyLevels);
        pixels_ += count;
        break;
      case Kept::kFloats:
        if (weights_.floats.size() - floats_ < count) return too_few(name);
        std::copy_n(weights_.floats.begin() + static_cast<std::ptrdiff_t>(floats_), count,
                    values.begin());
        floats_ += count;
        break;
    }
    tensor.copy_(torch::tensor(values).reshape(tensor.sizes()));
    return {};
  }

  [[nodiscard]] bool is_at_end() const {
    return bytes_ == weights_.bytes.size() && scales_ == weights_.scales.size() &&
           pixels_ == weights_.pixels.size() && floats_ == weights_.floats.size();
  }

 private:
  static Status too_few(const std::string& name) {
    return data_loss("found too few weights for '{}'", name);
  }

  const Weights& weights_;
  size_t bytes_ = 0, scales_ = 0, pixels_ = 0, floats_ = 0;
};

Status write_weights(h5::File& file, DeepModel& model) {
  const Weights weights = collect(model);
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/weights/bytes", weights.bytes));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/weights/scales", weights.scales));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/weights/pixels", weights.pixels));
  return write_vector(file, "/weights/floats", weights.floats);
}

Status read_weights(const h5::File& file, DeepModel& model) {
  Weights weights;
  ENGRAM_ASSIGN_OR_RETURN(weights.bytes, read_vector<int8_t>(file, "/weights/bytes"));
  ENGRAM_ASSIGN_OR_RETURN(weights.scales, read_vector<float>(file, "/weights/scales"));
  ENGRAM_ASSIGN_OR_RETURN(weights.pixels, read_vector<uint8_t>(file, "/weights/pixels"));
  ENGRAM_ASSIGN_OR_RETURN(weights.floats, read_vector<float>(file, "/weights/floats"));
  torch::NoGradGuard no_grad;
  WeightReader reader(weights);
  ENGRAM_RETURN_IF_ERROR(
      for_each_tensor(model, [&](const auto& name, Tensor& tensor, bool is_buffer) {
        return reader.read(name, tensor, is_buffer);
      }));
  if (!reader.is_at_end()) return data_loss("found more weights than the layout needs");
  return {};
}

Status write_tables(h5::File& file, const LatentCoder& coder) {
  std::vector<int32_t> firsts;
  std::vector<uint16_t> sizes, frequencies;
  for (const FrequencyTable& table : coder.tables()) {
    const auto values = table.frequencies();
    firsts.push_back(table.first());
    sizes.push_back(static_cast<uint16_t>(values.size()));
    frequencies.insert(frequencies.end(), values.begin(), values.end());
  }
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/tables/first", firsts));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/tables/symbols", sizes));
  return write_vector(file, "/tables/frequencies", frequencies);
}

Result<LatentCoder> read_tables(const h5::File& file, std::vector<LatentGrid> grids) {
  ENGRAM_ASSIGN_OR_RETURN(const auto firsts, read_vector<int32_t>(file, "/tables/first"));
  ENGRAM_ASSIGN_OR_RETURN(const auto sizes, read_vector<uint16_t>(file, "/tables/symbols"));
  ENGRAM_ASSIGN_OR_RETURN(const auto all, read_vector<uint16_t>(file, "/tables/frequencies"));
  if (firsts.size() != sizes.size())
    return data_loss("found {} first symbols for {} tables", firsts.size(), sizes.size());
  std::vector<FrequencyTable> tables;
  std::span<const uint16_t> frequencies(all);
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (frequencies.size() < sizes[i]) return data_loss("found too few frequencies");
    ENGRAM_ASSIGN_OR_RETURN(FrequencyTable table, FrequencyTable::from_frequencies(
                                                      firsts[i], frequencies.first(sizes[i])));
    tables.push_back(std::move(table));
    frequencies = frequencies.subspan(sizes[i]);
  }
  return LatentCoder::create(std::move(grids), std::move(tables));
}

Status write_spans(h5::File& file, const std::string& path, const std::vector<TimeSpan>& spans) {
  std::vector<int64_t> ends;
  for (const TimeSpan& span : spans) {
    ends.push_back(to_ns(span.first));
    ends.push_back(to_ns(span.last));
  }
  return write_vector(file, path, ends);
}

Result<std::vector<TimeSpan>> read_spans(const h5::File& file, const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(const auto ends, read_vector<int64_t>(file, path));
  std::vector<TimeSpan> spans;
  for (size_t i = 0; i + 1 < ends.size(); i += 2)
    spans.push_back({time_from_ns(ends[i]), time_from_ns(ends[i + 1])});
  return spans;
}

Status write_provenance(h5::File& file, const Provenance& from) {
  ENGRAM_RETURN_IF_ERROR(file.make_group("/provenance"));
  const std::string group = "/provenance";
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "entity", std::string_view(from.entity)));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute(group, "code_version", std::string_view(from.code_version)));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "seed", static_cast<int64_t>(from.seed)));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "steps", from.steps));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "training_seconds", from.training_seconds));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "final_loss", from.final_loss));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "lambda", from.lambda));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "number_error", from.number_error));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "snapshots", from.snapshots));
  ENGRAM_RETURN_IF_ERROR(write_spans(file, group + "/autoencoder_spans", from.autoencoder_spans));
  return write_spans(file, group + "/dynamics_spans", from.dynamics_spans);
}

Result<Provenance> read_provenance_of(const h5::File& file) {
  const std::string group = "/provenance";
  Provenance from;
  ENGRAM_ASSIGN_OR_RETURN(from.entity, file.string_attribute(group, "entity"));
  ENGRAM_ASSIGN_OR_RETURN(from.code_version, file.string_attribute(group, "code_version"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t seed, file.int_attribute(group, "seed"));
  from.seed = static_cast<uint64_t>(seed);
  ENGRAM_ASSIGN_OR_RETURN(from.steps, file.int_attribute(group, "steps"));
  ENGRAM_ASSIGN_OR_RETURN(from.training_seconds, file.double_attribute(group, "training_seconds"));
  ENGRAM_ASSIGN_OR_RETURN(from.final_loss, file.double_attribute(group, "final_loss"));
  ENGRAM_ASSIGN_OR_RETURN(from.lambda, file.double_attribute(group, "lambda"));
  ENGRAM_ASSIGN_OR_RETURN(from.number_error, file.double_attribute(group, "number_error"));
  ENGRAM_ASSIGN_OR_RETURN(from.snapshots, file.int_attribute(group, "snapshots"));
  ENGRAM_ASSIGN_OR_RETURN(from.autoencoder_spans, read_spans(file, group + "/autoencoder_spans"));
  ENGRAM_ASSIGN_OR_RETURN(from.dynamics_spans, read_spans(file, group + "/dynamics_spans"));
  return from;
}

Status write_prediction(h5::File& file, const PredictionRecord& record) {
  std::vector<double> images, numbers, image_errors, number_errors;
  for (size_t i = 0; i < record.expected.size(); ++i) {
    images.push_back(record.image_gates[i]);
    numbers.push_back(record.number_gates[i]);
    image_errors.push_back(record.expected[i].image_mse);
    number_errors.push_back(record.expected[i].number_mse);
  }
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/prediction/image_gates", images));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/prediction/number_gates", numbers));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/prediction/image_mse", image_errors));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/prediction/number_mse", number_errors));
  return file.write_attribute("/prediction", "step_ns", static_cast<int64_t>(record.step.count()));
}

Result<PredictionRecord> read_prediction(const h5::File& file) {
  PredictionRecord record;
  ENGRAM_ASSIGN_OR_RETURN(const auto images, read_vector<double>(file, "/prediction/image_gates"));
  ENGRAM_ASSIGN_OR_RETURN(const auto numbers,
                          read_vector<double>(file, "/prediction/number_gates"));
  ENGRAM_ASSIGN_OR_RETURN(const auto image_mse, read_vector<double>(file, "/prediction/image_mse"));
  ENGRAM_ASSIGN_OR_RETURN(const auto number_mse,
                          read_vector<double>(file, "/prediction/number_mse"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t step, file.int_attribute("/prediction", "step_ns"));
  for (const auto* values : {&images, &numbers, &image_mse, &number_mse})
    if (values->size() != kMeasuredHorizons)
      return data_loss("found {} horizons, needs {}", values->size(), kMeasuredHorizons);
  for (size_t i = 0; i < kMeasuredHorizons; ++i) {
    if (!(images[i] >= 0 && images[i] <= 1 && numbers[i] >= 0 && numbers[i] <= 1))
      return data_loss("found a gate outside 0..1");
    record.image_gates[i] = images[i];
    record.number_gates[i] = numbers[i];
    record.expected[i] = {image_mse[i], number_mse[i]};
  }
  record.step = Duration(step);
  return record;
}

/// Every image element and every number of a decoded value: what the self test compares.
struct SelfTest {
  std::vector<double> grey_levels;
  std::vector<double> numbers;  ///< In standard deviations.
};

Result<SelfTest> decoded_example(DeepModel& model, std::span<const std::byte> code) {
  constexpr int64_t kMostPixels = 512;
  torch::NoGradGuard no_grad;
  SelfTest test;
  ENGRAM_ASSIGN_OR_RETURN(const auto integers, model.coder.decode(code));
  const Parts parts = model.autoencoder->decode(model.to_latents(integers));
  for (const Tensor& image : parts.images) {
    const Tensor flat = image.contiguous().flatten().clamp(0, 255);
    const int64_t stride = std::max<int64_t>(1, flat.numel() / kMostPixels);
    for (int64_t i = 0; i < flat.numel(); i += stride)
      test.grey_levels.push_back(flat.data_ptr<float>()[i]);
  }
  if (parts.numbers.defined())
    for (const float number : floats_of(parts.numbers)) test.numbers.push_back(number);
  return test;
}

Status write_self_test(h5::File& file, DeepModel& model, const idf::Data& example) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Latent latent, model.encode(example));
  ENGRAM_ASSIGN_OR_RETURN(const SelfTest test, decoded_example(model, latent.code.bytes()));
  const auto* bytes = reinterpret_cast<const uint8_t*>(latent.code.data());
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/self_test/code",
                                      std::vector<uint8_t>(bytes, bytes + latent.code.size())));
  std::vector<float> grey(test.grey_levels.begin(), test.grey_levels.end());
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/self_test/grey_levels", grey));
  std::vector<float> numbers(test.numbers.begin(), test.numbers.end());
  return write_vector(file, "/self_test/numbers", numbers);
}

Status check_close(std::span<const float> stored, std::span<const double> found, double tolerance,
                   std::string_view what) {
  if (stored.size() != found.size())
    return data_loss("self test: found {} {}, needs {}", found.size(), what, stored.size());
  for (size_t i = 0; i < found.size(); ++i)
    if (!(std::abs(found[i] - static_cast<double>(stored[i])) <= tolerance))
      return data_loss("self test: decoded {} {} is {}, needs {} within {}", what, i, found[i],
                       stored[i], tolerance);
  return {};
}

Status run_self_test(const h5::File& file, DeepModel& model) {
  ENGRAM_ASSIGN_OR_RETURN(const auto code, read_vector<uint8_t>(file, "/self_test/code"));
  ENGRAM_ASSIGN_OR_RETURN(const SelfTest test,
                          decoded_example(model, std::as_bytes(std::span(code))));
  ENGRAM_ASSIGN_OR_RETURN(const auto grey, read_vector<float>(file, "/self_test/grey_levels"));
  ENGRAM_ASSIGN_OR_RETURN(const auto numbers, read_vector<float>(file, "/self_test/numbers"));
  ENGRAM_RETURN_IF_ERROR(check_close(grey, test.grey_levels, kImageTolerance, "grey level"));
  return check_close(numbers, test.numbers, kNumberTolerance, "number");
}

Status write_model(DeepModel& model, const idf::Data& example, const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "format", kFormat));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "version", int64_t{kModelFormatVersion}));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute("/", "width", int64_t{model.autoencoder->shape.width}));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "latent_channels",
                                              int64_t{model.autoencoder->shape.latent_channels}));
  ENGRAM_ASSIGN_OR_RETURN(const auto layout, idf::encode(model.plan.layout().to_data()));
  const auto* bytes = reinterpret_cast<const uint8_t*>(layout.data());
  ENGRAM_RETURN_IF_ERROR(
      write_vector(file, "/layout", std::vector<uint8_t>(bytes, bytes + layout.size())));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/normaliser/mean", model.mean));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/normaliser/deviation", model.deviation));
  std::vector<double> scales;
  for (const ImageMember& image : model.plan.images()) scales.push_back(image.scale);
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/normaliser/image_scale", scales));
  ENGRAM_RETURN_IF_ERROR(write_weights(file, model));
  ENGRAM_RETURN_IF_ERROR(write_tables(file, model.coder));
  ENGRAM_RETURN_IF_ERROR(write_prediction(file, model.prediction));
  ENGRAM_RETURN_IF_ERROR(write_provenance(file, model.provenance));
  ENGRAM_RETURN_IF_ERROR(write_self_test(file, model, example));
  return file.close();
}

Status check_format(const h5::File& file) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string format, file.string_attribute("/", "format"));
  if (format != kFormat) return data_loss("found format '{}', needs '{}'", format, kFormat);
  ENGRAM_ASSIGN_OR_RETURN(const int64_t version, file.int_attribute("/", "version"));
  if (version > kModelFormatVersion)
    return failed_precondition("found version {}, this program reads up to {}", version,
                               kModelFormatVersion);
  return {};
}

Result<TensorPlan> read_plan(const h5::File& file) {
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, read_vector<uint8_t>(file, "/layout"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data, idf::decode(Buffer::take(bytes)));
  ENGRAM_ASSIGN_OR_RETURN(idf::Layout layout, idf::Layout::from_data(data));
  ENGRAM_ASSIGN_OR_RETURN(TensorPlan plan, TensorPlan::create(std::move(layout)));
  ENGRAM_ASSIGN_OR_RETURN(const auto scales, read_vector<double>(file, "/normaliser/image_scale"));
  if (scales.size() != plan.images().size())
    return data_loss("found {} image scales, needs {}", scales.size(), plan.images().size());
  for (size_t i = 0; i < scales.size(); ++i) {
    if (!(scales[i] > 0 && scales[i] <= 255)) return data_loss("found image scale {}", scales[i]);
    plan.images()[i].scale = scales[i];
  }
  return plan;
}

Result<std::shared_ptr<DeepModel>> read_checked(const h5::File& file) {
  ENGRAM_ASSIGN_OR_RETURN(TensorPlan plan, read_plan(file));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t width, file.int_attribute("/", "width"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t latents, file.int_attribute("/", "latent_channels"));
  if (width < 2 || width > kMaxWidth || latents < 1 || latents > kMaxLatentChannels)
    return data_loss("found width {} and {} latent channels, needs 2..{} and 1..{}", width, latents,
                     kMaxWidth, kMaxLatentChannels);
  const NetworkShape shape =
      network_shape(plan, static_cast<int>(width), static_cast<int>(latents));
  auto model = std::make_shared<DeepModel>(std::move(plan), shape);
  ENGRAM_ASSIGN_OR_RETURN(model->mean, read_vector<double>(file, "/normaliser/mean"));
  ENGRAM_ASSIGN_OR_RETURN(model->deviation, read_vector<double>(file, "/normaliser/deviation"));
  const size_t numbers = model->plan.number_count();
  if (model->mean.size() != numbers || model->deviation.size() != numbers)
    return data_loss("found a normaliser of {} numbers, needs {}", model->mean.size(), numbers);
  ENGRAM_RETURN_IF_ERROR(read_weights(file, *model));
  ENGRAM_ASSIGN_OR_RETURN(model->coder, read_tables(file, shape.grids()));
  ENGRAM_ASSIGN_OR_RETURN(model->prediction, read_prediction(file));
  ENGRAM_ASSIGN_OR_RETURN(model->provenance, read_provenance_of(file));
  ENGRAM_RETURN_IF_ERROR(run_self_test(file, *model));
  return model;
}

/// What a broken file makes other functions say, told as what it is.
Status as_damage(const Status& status, const std::filesystem::path& path) {
  const std::string text = fmt::format("model '{}': {}", path.string(), status.message());
  if (status.code() == StatusCode::kFailedPrecondition) return failed_precondition("{}", text);
  return data_loss("{}", text);
}

}  // namespace

Status save_model(DeepModel& model, const idf::Data& example, const std::filesystem::path& path) {
  return guarded("save model", [&] { return write_model(model, example, path); });
}

Result<std::shared_ptr<DeepModel>> read_model(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, h5::File::open(path));
  if (const Status status = check_format(file); !status.ok()) return as_damage(status, path);
  auto model = guarded("load model", [&] { return read_checked(file); });
  if (!model.ok()) return as_damage(model.status(), path);
  return model;
}

Result<Provenance> read_provenance(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, h5::File::open(path));
  if (const Status status = check_format(file); !status.ok()) return as_damage(status, path);
  auto provenance = read_provenance_of(file);
  if (!provenance.ok()) return as_damage(provenance.status(), path);
  return provenance;
}

}  // namespace engram::encoders
