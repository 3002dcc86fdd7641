// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "datasets/folders/folder_formats.h"
#include "ltm/codec/png.h"
#include "tests/fuzz/fuzz_check.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

/// What is hostile, and the format whose folder it lies in.
struct Target {
  std::string file;
  std::unique_ptr<const RecordingFormat> format;
};

/// Folders with an image each and one file that is written anew for every input.
class Folders {
 public:
  Folders() {
    add("tum", "rgb.txt", make_tum_format());
    add("poses", "groundtruth.txt", make_tum_format());
    add("7scenes", "frame-000000.pose.txt", make_seven_scenes_format());
    add("table", "times.csv", make_images_format());
    add("words", "times.txt", make_images_format());
    add("euroc/imu0", "data.csv", make_euroc_format());
  }

  Result<std::unique_ptr<RecordingReader>> open(size_t which, std::span<const std::byte> content) {
    const auto& [file, format] = targets_[which % targets_.size()];
    overwrite_file(scratch_ / file, content);
    const auto folder = (scratch_ / file).parent_path();
    const bool is_euroc = folder.filename() == "imu0";
    return format->open(is_euroc ? folder.parent_path() : folder, {});
  }

 private:
  void add(const std::string& folder, const std::string& file,
           std::unique_ptr<const RecordingFormat> format) {
    std::filesystem::create_directories(scratch_ / folder);
    const auto png = ltm::png_codec().encode(idf::NdArray::take<uint8_t>({1, 1, 1}, {7}));
    ENGRAM_CHECK(png.ok(), "{}", png.status().message());
    overwrite_file(scratch_ / folder / "frame-000000.color.png", *png);
    targets_.push_back({folder + "/" + file, std::move(format)});
  }

  ScratchDirectory scratch_;
  std::vector<Target> targets_;
};

}  // namespace
}  // namespace engram::datasets

/// The first byte says which file of which format the rest is. What comes in is in the order of
/// time, and commits.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::datasets;
  static Folders folders;
  if (size == 0) return 0;
  const auto reader = folders.open(data[0], std::as_bytes(std::span(data, size)).subspan(1));
  std::map<ltm::MemoryId, Time> last;
  while (reader.ok()) {
    const auto moment = (*reader)->next();
    if (!moment.ok() || !*moment) break;
    const ltm::Commit& commit = (*moment)->commit;
    if (commit.updates.empty()) continue;
    const Status status = commit.check();
    ENGRAM_CHECK(status.ok(), "{}", status.message());
    for (const ltm::EntityUpdate& update : commit.updates) {
      const auto [before, is_first] = last.try_emplace(update.entity, update.time);
      ENGRAM_CHECK(is_first || before->second < update.time, "times of an entity do not increase");
      before->second = update.time;
    }
  }
  return 0;
}
