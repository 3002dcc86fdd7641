// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/attention_weights.h"

#include "encoders/stored_tensors.h"
#include "ltm/core/file.h"
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
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path));
  ENGRAM_RETURN_IF_ERROR(file.make_group(kGroup));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "version", kVersion));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "min_confidence", record.min_confidence));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "sure_confidence", record.sure_confidence));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "examples", record.examples));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kGroup, "seconds", record.seconds));
  ENGRAM_RETURN_IF_ERROR(file.write_strings(kSymbols, program_symbols()));
  ENGRAM_RETURN_IF_ERROR(encoders::write_tensors(file, kWeights, layers->parameters()));
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
  std::vector<torch::Tensor> weights = saved.layers->parameters();
  ENGRAM_RETURN_IF_ERROR(encoders::read_tensors(file, path, kWeights, weights));
  saved.layers->eval();
  return saved;
}

}  // namespace engram::speech
