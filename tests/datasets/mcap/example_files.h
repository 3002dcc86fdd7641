// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "datasets/mcap/mcap_format.h"
#include "datasets/mcap/mcap_writer.h"
#include "datasets/recordings/import_recording.h"
#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets::mcap {

/// Files of the format's own conformance suite, equal to those by their SHA-256.
inline std::filesystem::path golden(std::string_view name) {
  return std::filesystem::path(ENGRAM_SOURCE_DIR) / "tests/golden/mcap" / name;
}

inline std::string content_of(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  ENGRAM_CHECK(bytes.ok(), "{}", bytes.status().to_string());
  return std::string(as_text(bytes->bytes()));
}

/// A message of that suite.
inline void write_example(McapWriter& writer) {
  writer.add(SchemaRecord{1, "Example", "c", "\x04\x05\x06"});
  writer.add(ChannelRecord{1, 1, "example", "a", {{"foo", "bar"}}});
  static constexpr std::string_view kData = "\x01\x02\x03";
  ENGRAM_CHECK(writer.write(MessageRecord{1, 10, 2, 1, as_bytes(kData)}).ok(), "no message");
}

inline Result<std::unique_ptr<RecordingReader>> open(const std::filesystem::path& path,
                                                     const ReadingOptions& options = {}) {
  return make_mcap_format()->open(path, options);
}

/// All that a reader gives.
struct Contents {
  std::vector<ltm::EntityUpdate> updates;
  std::vector<RecordingEpisode> episodes;
  std::vector<RecordingStream> streams;
  ReadingReport report;
};

inline Result<Contents> read_all(const std::filesystem::path& path,
                                 const ReadingOptions& options = {}) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, open(path, options));
  Contents contents;
  contents.streams = reader->streams();
  Time last = Time::min();
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(auto moment, reader->next());
    if (!moment) break;
    if (moment->begins) contents.episodes.push_back(*moment->begins);
    if (!moment->commit.updates.empty()) {
      ENGRAM_RETURN_IF_ERROR(moment->commit.check());
      ENGRAM_CHECK(moment->commit.updates[0].time >= last, "times go back");
      last = moment->commit.updates[0].time;
    }
    for (auto& update : moment->commit.updates) contents.updates.push_back(std::move(update));
  }
  contents.report = reader->report();
  return contents;
}

}  // namespace engram::datasets::mcap
