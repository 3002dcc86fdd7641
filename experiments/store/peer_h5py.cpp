// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "ltm/core/file.h"
#include "store/peer_run.h"

namespace engram::experiments {

namespace {

namespace fs = std::filesystem;

/// Passes the stream to another program: the decoded frames in one file, everything else as JSON.
class HandOver {
 public:
  explicit HandOver(fs::path folder) : folder_(std::move(folder)) {}

  Status write(const Stream& stream, const std::vector<ImageRead>& reads) const {
    ENGRAM_RETURN_IF_ERROR(make_empty(folder_));
    ENGRAM_RETURN_IF_ERROR(write_frames(stream));
    nlohmann::json said{{"frames", stream.frames().size()}};
    for (size_t i = 0; i < stream.ticks(); ++i) said["ticks"].push_back(tick_json(stream, i));
    for (const ImageRead& it : reads) said["reads"].push_back({it.camera, it.tick});
    return replace_file(fs::absolute(folder_ / "stream.json"), as_bytes(said.dump()));
  }

 private:
  Status write_frames(const Stream& stream) const {
    ENGRAM_ASSIGN_OR_RETURN(File file, File::open(folder_ / "frames", File::Mode::kCreate));
    for (const idf::NdArray& frame : stream.frames())
      ENGRAM_RETURN_IF_ERROR(file.append(frame.bytes()));
    return {};
  }

  static nlohmann::json tick_json(const Stream& stream, size_t index) {
    const Tick tick = stream.tick(index);
    nlohmann::json said{{"time", to_ns(tick.time)},
                        {"positions", tick.positions},
                        {"velocities", tick.velocities},
                        {"text", tick.text}};
    for (size_t i = 0; i < tick.images.size(); ++i)
      said["images"].push_back(stream.frame_index(i, index));
    for (const Tick::Pose& pose : tick.poses) said["poses"][pose.name] = pose.matrix;
    return said;
  }

  fs::path folder_;
};

Result<nlohmann::json> run_script(const fs::path& stream, const fs::path& folder) {
  const fs::path report = folder / "report.json";
  const std::string command =
      fmt::format("/usr/bin/python3 '{}' '{}' '{}' '{}'", ENGRAM_H5PY_SCRIPT, stream.string(),
                  (folder / "stream.h5").string(), report.string());
  const int code = std::system(command.c_str());
  if (code != 0) return unavailable("'{}': ended with wait status {}", command, code);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer text, read_file(report));
  ENGRAM_RETURN_IF_ERROR(remove_file(report));
  nlohmann::json found = nlohmann::json::parse(as_text(text.bytes()), nullptr, false);
  if (found.is_discarded()) return data_loss("report '{}': is no JSON", report.string());
  return found;
}

}  // namespace

Result<PeerFigures> run_h5py(const Stream& stream, const std::vector<ImageRead>& reads,
                             const fs::path& folder) {
  const fs::path handed = folder.parent_path() / "h5py_stream";
  ENGRAM_RETURN_IF_ERROR(HandOver(handed).write(stream, reads));
  ENGRAM_RETURN_IF_ERROR(make_empty(folder));
  ENGRAM_ASSIGN_OR_RETURN(const nlohmann::json found, run_script(handed, folder));
  PeerFigures figures;
  figures.name = "h5py, gzip";
  figures.write_seconds = found.at("write_seconds");
  figures.write_cpu_seconds = found.at("write_cpu_seconds");
  figures.read = summarize(found.at("read_seconds").get<std::vector<double>>());
  const Stopwatch clock;
  ENGRAM_RETURN_IF_ERROR(sync_tree(folder));
  figures.sync_seconds = clock.seconds();
  ENGRAM_ASSIGN_OR_RETURN(figures.disk_bytes, tree_bytes(folder));
  ENGRAM_RETURN_IF_ERROR(make_empty(handed));
  return figures;
}

}  // namespace engram::experiments
