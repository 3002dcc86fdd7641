// SPDX-License-Identifier: Apache-2.0
#include "encoders/deep_model_file.h"

#include <algorithm>
#include <utility>

#include "encoders/model_format.h"
#include "encoders/model_records.h"
#include "encoders/model_self_test.h"
#include "encoders/model_vectors.h"
#include "encoders/model_weights.h"
#include "encoders/provenance_records.h"
#include "ltm/idf/binary.h"

namespace engram::encoders {

namespace {

/// Visits the integers in the root of the file that give the sizes of the networks.
template <typename Visit>
Status for_each_size(NetworkSizes& sizes, Visit visit) {
  ENGRAM_RETURN_IF_ERROR(visit("width", sizes.width));
  ENGRAM_RETURN_IF_ERROR(visit("coarse_channels", sizes.coarse_channels));
  ENGRAM_RETURN_IF_ERROR(visit("fine_channels", sizes.fine_channels));
  ENGRAM_RETURN_IF_ERROR(visit("scenes", sizes.scenes));
  return visit("conditions", sizes.conditions);
}

Result<NetworkSizes> read_sizes(const h5::File& file) {
  NetworkSizes sizes;
  ENGRAM_RETURN_IF_ERROR(for_each_size(sizes, [&](const char* name, int& size) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t value, file.int_attribute("/", name));
    size = static_cast<int>(std::clamp<int64_t>(value, -1, INT32_MAX));
    return {};
  }));
  if (!sizes.is_valid())
    return data_loss("found a width of {}, {} and {} latent channels, {} scenes", sizes.width,
                     sizes.coarse_channels, sizes.fine_channels, sizes.scenes);
  return sizes;
}

Status write_model(DeepModel& model, const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "format", kModelFormat));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "version", int64_t{kModelFormatVersion}));
  NetworkSizes sizes = model.autoencoder->shape.sizes;
  ENGRAM_RETURN_IF_ERROR(for_each_size(sizes, [&](const char* name, int size) {
    return file.write_attribute("/", name, int64_t{size});
  }));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute("/", "chain_rows", static_cast<int64_t>(model.codec.chain_rows)));
  ENGRAM_ASSIGN_OR_RETURN(const auto layout, idf::encode(model.plan.layout().to_data()));
  const auto* bytes = reinterpret_cast<const uint8_t*>(layout.data());
  ENGRAM_RETURN_IF_ERROR(
      write_vector(file, "/layout", std::vector<uint8_t>(bytes, bytes + layout.size())));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/normaliser/mean", model.mean));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/normaliser/deviation", model.deviation));
  std::vector<double> scales;
  // The scale of a depth image is chosen in training, so a layout alone does not give it.
  for (const ImageMember& image : model.plan.images()) scales.push_back(image.scale);
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/normaliser/image_scale", scales));
  ENGRAM_RETURN_IF_ERROR(write_weights(file, model));
  ENGRAM_RETURN_IF_ERROR(write_codec(file, model.codec));
  ENGRAM_RETURN_IF_ERROR(write_global_code(file, model.global_code));
  if (model.condition) ENGRAM_RETURN_IF_ERROR(write_condition(file, *model.condition));
  ENGRAM_RETURN_IF_ERROR(write_prediction(file, "/prediction", model.prediction));
  ENGRAM_RETURN_IF_ERROR(write_prediction(file, "/unconditioned", model.unconditioned));
  ENGRAM_RETURN_IF_ERROR(write_prediction(file, "/planned", model.planned));
  ENGRAM_RETURN_IF_ERROR(write_prediction(file, "/copied", model.copied));
  ENGRAM_RETURN_IF_ERROR(write_provenance(file, model.provenance));
  ENGRAM_RETURN_IF_ERROR(write_self_test(file, model));
  return file.close();
}

Result<TensorPlan> read_plan(const h5::File& file) {
  ENGRAM_ASSIGN_OR_RETURN(idf::Layout layout, read_layout(file));
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
  ENGRAM_ASSIGN_OR_RETURN(const NetworkSizes sizes, read_sizes(file));
  // This check comes before the networks are made: a hostile file could otherwise request any
  // amount of memory for backgrounds.
  for (const ImageShape& image : network_shape(plan, sizes).images)
    if (sizes.scenes > max_scenes(image))
      return data_loss("found {} backgrounds of {} x {} pixels, needs at most {}", sizes.scenes,
                       image.height, image.width, max_scenes(image));
  auto model = std::make_shared<DeepModel>(std::move(plan), sizes);
  ENGRAM_ASSIGN_OR_RETURN(const int64_t rows, file.int_attribute("/", "chain_rows"));
  if (rows < 1 || rows > static_cast<int64_t>(kMaxBlockRows))
    return data_loss("found chains of {} rows, needs 1 to {}", rows, kMaxBlockRows);
  model->codec.chain_rows = static_cast<size_t>(rows);
  ENGRAM_ASSIGN_OR_RETURN(model->mean, read_vector<double>(file, "/normaliser/mean"));
  ENGRAM_ASSIGN_OR_RETURN(model->deviation, read_vector<double>(file, "/normaliser/deviation"));
  const size_t numbers = model->plan.number_count();
  if (model->mean.size() != numbers || model->deviation.size() != numbers)
    return data_loss("found a normaliser of {} numbers, needs {}", model->mean.size(), numbers);
  ENGRAM_RETURN_IF_ERROR(read_weights(file, *model));
  ENGRAM_RETURN_IF_ERROR(read_codec(file, model->autoencoder->shape, model->codec));
  ENGRAM_ASSIGN_OR_RETURN(model->global_code, read_global_code(file, model->autoencoder->shape));
  if (sizes.conditions > 0) {
    ENGRAM_ASSIGN_OR_RETURN(model->condition, read_condition(file, sizes.conditions));
  }
  ENGRAM_ASSIGN_OR_RETURN(model->prediction, read_prediction(file, "/prediction"));
  ENGRAM_ASSIGN_OR_RETURN(model->unconditioned, read_prediction(file, "/unconditioned"));
  ENGRAM_ASSIGN_OR_RETURN(model->planned, read_prediction(file, "/planned"));
  ENGRAM_ASSIGN_OR_RETURN(model->copied, read_prediction(file, "/copied"));
  ENGRAM_ASSIGN_OR_RETURN(model->provenance, read_provenance(file));
  ENGRAM_RETURN_IF_ERROR(run_self_test(file, *model));
  return model;
}

}  // namespace

Status save_model(DeepModel& model, const std::filesystem::path& path) {
  return guarded("save model", [&] { return write_model(model, path); });
}

Status note_choice(const ModelChoice& choice, const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::change(path));
  ENGRAM_RETURN_IF_ERROR(replace_choice(file, choice));
  return file.close();
}

Result<std::shared_ptr<DeepModel>> read_model(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, open_model_file(path));
  auto model = guarded("load model", [&] { return read_checked(file); });
  if (!model.ok()) return damaged_model(model.status(), path);
  return model;
}

}  // namespace engram::encoders
