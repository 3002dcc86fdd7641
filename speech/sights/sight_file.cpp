// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/sight_file.h"

#include <cmath>

#include "encoders/stored_tensors.h"
#include "ltm/core/file.h"

namespace engram::speech {

namespace {

constexpr const char* kGroup = "/sights";
constexpr const char* kWeights = "/sights/weights";
constexpr const char* kKinds = "/sights/kinds";
constexpr const char* kWhere = "/sights/where";
constexpr const char* kColours = "/sights/colours";
/// Counts what the numbers of cells and weights mean.
constexpr int64_t kVersion = 1;
/// What is more is no sight of a robot.
constexpr size_t kMaxWords = 1000;
constexpr int64_t kMaxSide = 1024;

/// Weights and what normalises cells, in the order of the layers.
std::vector<torch::Tensor> tensors_of(const SightLayers& layers) {
  std::vector<torch::Tensor> all = layers->parameters();
  for (const torch::Tensor& buffer : layers->buffers()) all.push_back(buffer);
  return all;
}

Status write(const SavedSights& sights, const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path));
  ENGRAM_RETURN_IF_ERROR(file.make_group(kGroup));
  const std::array<std::pair<const char*, int64_t>, 6> numbers{
      {{"version", kVersion},
       {"model", static_cast<int64_t>(sights.model)},
       {"channels", sights.grid.channels},
       {"rows", sights.grid.rows},
       {"columns", sights.grid.columns},
       {"images", sights.images}}};
  for (const auto& [name, number] : numbers)
    ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, name, number));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "min_probability", sights.min_probability));
  ENGRAM_RETURN_IF_ERROR(file.write_strings(kKinds, sights.words.kinds));
  ENGRAM_RETURN_IF_ERROR(file.write_strings(kWhere, sights.words.where));
  ENGRAM_RETURN_IF_ERROR(file.write_strings(kColours, sights.words.colours));
  ENGRAM_RETURN_IF_ERROR(encoders::write_tensors(file, kWeights, tensors_of(sights.layers)));
  return file.close();
}

Status read_numbers(const h5::File& file, const std::filesystem::path& path, SavedSights& sights) {
  int64_t channels = 0;
  int64_t rows = 0;
  int64_t columns = 0;
  ENGRAM_ASSIGN_OR_RETURN(const int64_t model, file.int_attribute(kGroup, "model"));
  ENGRAM_ASSIGN_OR_RETURN(channels, file.int_attribute(kGroup, "channels"));
  ENGRAM_ASSIGN_OR_RETURN(rows, file.int_attribute(kGroup, "rows"));
  ENGRAM_ASSIGN_OR_RETURN(columns, file.int_attribute(kGroup, "columns"));
  ENGRAM_ASSIGN_OR_RETURN(sights.images, file.int_attribute(kGroup, "images"));
  ENGRAM_ASSIGN_OR_RETURN(sights.min_probability, file.double_attribute(kGroup, "min_probability"));
  for (const int64_t size : {channels, rows, columns})
    if (size < 1 || size > kMaxSide)
      return data_loss("'{}': found a grid of {} x {} x {}", path.string(), channels, rows,
                       columns);
  if (!std::isfinite(sights.min_probability))
    return data_loss("'{}': its limit is no number", path.string());
  sights.model = static_cast<uint64_t>(model);
  sights.grid = {static_cast<int>(channels), static_cast<int>(rows), static_cast<int>(columns)};
  return {};
}

}  // namespace

SightShape SavedSights::shape() const {
  return {grid.channels, static_cast<int64_t>(words.kinds.size()),
          static_cast<int64_t>(words.where.size()), static_cast<int64_t>(words.colours.size())};
}

Status save_sights(const SavedSights& sights, const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  std::error_code error;
  std::filesystem::remove(part, error);
  ENGRAM_RETURN_IF_ERROR(write(sights, part));
  return publish_file(part, path);
}

Result<SavedSights> read_sights(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, h5::File::open(path));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t version, file.int_attribute(kGroup, "version"));
  if (version != kVersion)
    return failed_precondition("'{}': found version {} of sights, needs {}", path.string(), version,
                               kVersion);
  SavedSights sights;
  ENGRAM_RETURN_IF_ERROR(read_numbers(file, path, sights));
  ENGRAM_ASSIGN_OR_RETURN(sights.words.kinds, file.read_strings(kKinds));
  ENGRAM_ASSIGN_OR_RETURN(sights.words.where, file.read_strings(kWhere));
  ENGRAM_ASSIGN_OR_RETURN(sights.words.colours, file.read_strings(kColours));
  for (const auto* words : {&sights.words.kinds, &sights.words.where, &sights.words.colours})
    if (words->empty() || words->size() > kMaxWords)
      return data_loss("'{}': found {} words", path.string(), words->size());
  sights.layers = SightLayers(sights.shape());
  std::vector<torch::Tensor> tensors = tensors_of(sights.layers);
  ENGRAM_RETURN_IF_ERROR(encoders::read_tensors(file, path, kWeights, tensors));
  sights.layers->eval();
  return sights;
}

}  // namespace engram::speech
