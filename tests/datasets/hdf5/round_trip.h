// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "datasets/hdf5/hdf5_formats.h"
#include "datasets/recordings/import_recording.h"

namespace engram::datasets {

inline std::unique_ptr<const RecordingFormat> hdf5_format(std::string_view name) {
  return name == "aloha" ? make_aloha_format() : make_robomimic_format();
}

/// Imports a file or folder into a store.
inline Result<RecordingImportReport> import_hdf5(std::string_view format,
                                                 const std::filesystem::path& from,
                                                 const std::filesystem::path& store,
                                                 const ReadingOptions& options = {}) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, hdf5_format(format)->open(from, options));
  ENGRAM_ASSIGN_OR_RETURN(auto recorder, ltm::Recorder::open(store, {}));
  ENGRAM_ASSIGN_OR_RETURN(auto report, import_recording(*reader, format, recorder, {}, {}));
  ENGRAM_RETURN_IF_ERROR(recorder.close());
  return report;
}

struct Exported {
  std::map<std::string, uint64_t, std::less<>> not_held;
  ExportReport report;
};

inline Result<Exported> export_hdf5(std::string_view format, const std::filesystem::path& store,
                                    const std::filesystem::path& to,
                                    const WritingOptions& options = {},
                                    const std::string& text = "@ all",
                                    const std::stop_token& stop = {}) {
  ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store));
  ltm::Recall recall(std::move(reader), {});
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse(text));
  Exported exported;
  ENGRAM_ASSIGN_OR_RETURN(exported.not_held, hdf5_format(format)->not_held(recall, query, options));
  ENGRAM_ASSIGN_OR_RETURN(exported.report,
                          hdf5_format(format)->write(recall, query, to, options, {}, stop));
  return exported;
}

}  // namespace engram::datasets
