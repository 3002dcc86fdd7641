// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_sink.h"

#include "datasets/export_formats.h"

namespace engram::datasets {

namespace {

constexpr double kMinRate_hz = 0.01;
constexpr double kMaxRate_hz = 1000;
constexpr int kMaxCrf = 51;

}  // namespace

Status ExportOptions::validate() const {
  // The condition is negated so that NaN is rejected.
  if (rate_hz != 0 && !(rate_hz >= kMinRate_hz && rate_hz <= kMaxRate_hz))
    return invalid_argument("export: rate {} Hz, needs {} to {}", rate_hz, kMinRate_hz,
                            kMaxRate_hz);
  if (crf < 0 || crf > kMaxCrf)
    return invalid_argument("export: crf {}, needs 0 to {}", crf, kMaxCrf);
  return {};
}

Result<std::unique_ptr<SnapshotSink>> make_snapshot_sink(std::string_view format,
                                                         const std::filesystem::path& directory,
                                                         const ExportOptions& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  if (format == "jsonl") return make_json_lines_sink(directory);
  if (format == "csv") return make_csv_sink(directory);
  if (format == "png") return make_png_sink(directory);
  if (format == "mp4") return make_mp4_sink(directory, options);
  if (format == "armarx") return make_armarx_sink(directory);
  return invalid_argument("export: no format '{}', needs jsonl, csv, png, mp4 or armarx", format);
}

}  // namespace engram::datasets
