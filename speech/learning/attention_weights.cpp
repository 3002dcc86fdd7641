// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/attention_weights.h"

#include <cmath>

#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "speech/attention/program_symbols.h"

namespace engram::speech {

namespace {

constexpr const char* kGroup = "/attention";
constexpr const char* kWeights = "/attention/weights";
constexpr const char* kSymbols = "/attention/symbols";
/// Counts what the numbers of words and groups mean.
constexpr int64_t kVersion = 2;

Status write(AttentionLayers& layers, const AttentionRecord& record,
             const std::filesystem::path& path) {
  std::vector<float> weights;
  for (const torch::Tensor& tensor : layers->parameters()) {
    const torch::Tensor flat = tensor.detach().to(torch::kFloat).contiguous().flatten();
    weights.insert(weights.end(), flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel());
  }
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path));
  ENGRAM_RETURN_IF_ERROR(file.make_group(kGroup));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "version", kVersion));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "min_confidence", record.min_confidence));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "sure_confidence", record.sure_confidence));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "examples", record.examples));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "seconds", record.seconds));
  ENGRAM_RETURN_IF_ERROR(file.write_strings(kSymbols, program_symbols()));
  const uint64_t count = weights.size();
  ENGRAM_RETURN_IF_ERROR(file.write(kWeights, h5::Type::kFloat32, std::span(&count, 1),
                                    std::as_bytes(std::span(weights)), h5::Storage::kCompressed));
  return file.close();
}

}  // namespace

Status save_attention(AttentionLayers& layers, const AttentionRecord& record,
                      const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  std::filesystem::remove(part, error);
  ENGRAM_RETURN_IF_ERROR(write(layers, record, part));
  return publish_file(part, path);
}

Result<SavedAttention> read_attention(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, h5::File::open(path));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t version, file.int_attribute(kGroup, "version"));
  if (version != kVersion)
    return failed_precondition("'{}': found version {} of what answers by attention, needs {}",
                               path.string(), version, kVersion);
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<std::string> symbols, file.read_strings(kSymbols));
  if (symbols != program_symbols())
    return failed_precondition("'{}': its language of programs is of another version",
                               path.string());
  SavedAttention saved;
  ENGRAM_ASSIGN_OR_RETURN(saved.record.min_confidence,
                          file.double_attribute(kGroup, "min_confidence"));
  ENGRAM_ASSIGN_OR_RETURN(saved.record.sure_confidence,
                          file.double_attribute(kGroup, "sure_confidence"));
  ENGRAM_ASSIGN_OR_RETURN(saved.record.examples, file.int_attribute(kGroup, "examples"));
  ENGRAM_ASSIGN_OR_RETURN(saved.record.seconds, file.double_attribute(kGroup, "seconds"));
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes,
                          file.read(kWeights, h5::Type::kFloat32, uint64_t{1} << 26));
  const auto weights = h5::as_vector<float>(bytes);
  size_t at = 0;
  torch::NoGradGuard no_gradient;
  for (torch::Tensor& tensor : saved.layers->parameters()) {
    const auto count = static_cast<size_t>(tensor.numel());
    if (at + count > weights.size()) break;
    std::copy_n(weights.data() + at, count, tensor.data_ptr<float>());
    at += count;
  }
  size_t needed = 0;
  for (const torch::Tensor& tensor : saved.layers->parameters())
    needed += static_cast<size_t>(tensor.numel());
  if (weights.size() != needed)
    return data_loss("'{}': found {} weights, needs {}", path.string(), weights.size(), needed);
  for (const float weight : weights)
    if (!std::isfinite(weight))
      return data_loss("'{}': found a weight that is no number", path.string());
  saved.layers->eval();
  return saved;
}

}  // namespace engram::speech
