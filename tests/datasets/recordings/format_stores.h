// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "datasets/recordings/import_recording.h"
#include "datasets/recordings/recording_format.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets {

/// A format between files and stores.
class FormatStores {
 public:
  explicit FormatStores(std::unique_ptr<const RecordingFormat> format)
      : format_(std::move(format)) {}

  [[nodiscard]] Result<RecordingImportReport> import(const std::filesystem::path& file,
                                                     const std::filesystem::path& store) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, format_->open(file, {}));
    ENGRAM_ASSIGN_OR_RETURN(auto recorder, ltm::Recorder::open(store, {}));
    ENGRAM_ASSIGN_OR_RETURN(auto report,
                            import_recording(*reader, format_->name(), recorder, {}, {}));
    ENGRAM_RETURN_IF_ERROR(recorder.close());
    return report;
  }

  [[nodiscard]] Result<ExportReport> write(const std::filesystem::path& store,
                                           const std::filesystem::path& file,
                                           const WritingOptions& options = {}) const {
    ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store));
    ltm::Recall recall(std::move(reader), {});
    ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::parse("@ all"));
    return format_->write(recall, query, file, options, {}, {});
  }

  [[nodiscard]] std::map<std::string, uint64_t, std::less<>> not_held(
      const std::filesystem::path& store, const WritingOptions& options = {}) const {
    ltm::Recall recall(ltm::StoreReader::open(store).value(), {});
    return format_->not_held(recall, ltm::Query::parse("@ all").value(), options).value();
  }

  /// Values of one entity, 1 ns apart from `start` on, all of whose times are that.
  static void record(const std::filesystem::path& store, std::string_view entity,
                     const std::vector<idf::Data>& values,
                     Time start = time_from_ns(1'700'000'000'000'000'000)) {
    // Formats are asked for times of the far future, too.
    auto recorder = ltm::Recorder::open(store, {.max_ahead = ltm::AheadLimits::kNone});
    ASSERT_OK(recorder);
    Time time = start;
    for (const idf::Data& value : values) {
      ASSERT_OK(recorder->commit(
          {{{ltm::MemoryId::parse(entity).value(),
             time,
             {{value, {.created = time, .sent = time, .arrived = time, .provider = "x"}}}}}}));
      time += Duration(1);
    }
    ASSERT_OK(recorder->close());
  }

 private:
  std::unique_ptr<const RecordingFormat> format_;
};

}  // namespace engram::datasets
