// SPDX-License-Identifier: Apache-2.0
#include "encoders/model_file.h"

#include "encoders/model_format.h"
#include "encoders/model_vectors.h"
#include "encoders/provenance_records.h"
#include "ltm/idf/binary.h"

namespace engram::encoders {

namespace {

Status check_format(const h5::File& file) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string format, file.string_attribute("/", "format"));
  if (format != kModelFormat)
    return data_loss("found format '{}', needs '{}'", format, kModelFormat);
  ENGRAM_ASSIGN_OR_RETURN(const int64_t version, file.int_attribute("/", "version"));
  if (version != kModelFormatVersion)
    return failed_precondition("found version {}, this program reads version {}", version,
                               kModelFormatVersion);
  return {};
}

}  // namespace

Status damaged_model(const Status& status, const std::filesystem::path& path) {
  const std::string text = fmt::format("model '{}': {}", path.string(), status.message());
  if (status.code() == StatusCode::kFailedPrecondition) return failed_precondition("{}", text);
  return data_loss("{}", text);
}

Result<h5::File> open_model_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::open(path));
  if (const Status status = check_format(file); !status.ok()) return damaged_model(status, path);
  return file;
}

Result<idf::Layout> read_layout(const h5::File& file) {
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, read_vector<uint8_t>(file, "/layout"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data, idf::decode(Buffer::take(bytes)));
  return idf::Layout::from_data(data);
}

Result<Provenance> read_provenance(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, open_model_file(path));
  auto provenance = read_provenance(file);
  if (!provenance.ok()) return damaged_model(provenance.status(), path);
  return provenance;
}

Result<idf::Layout> read_layout(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const h5::File file, open_model_file(path));
  auto layout = read_layout(file);
  if (!layout.ok()) return damaged_model(layout.status(), path);
  return layout;
}

}  // namespace engram::encoders
