// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "memory/prior/prior.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::testing {

/// The bytes of a picture file of one colour (blue, green, red) or one grey.
inline std::string picture_file(const std::string& ending, int height, int width, int type,
                                const cv::Scalar& colour) {
  std::vector<uchar> bytes;
  cv::imencode(ending, cv::Mat(height, width, type, colour), bytes);
  return {bytes.begin(), bytes.end()};
}

/// A directory of prior knowledge that a test writes.
class PriorDirectory {
 public:
  void write(const std::filesystem::path& name, std::string_view text) const {
    std::filesystem::create_directories((scratch_ / name).parent_path());
    overwrite_file(scratch_ / name, std::as_bytes(std::span(text)));
  }

  [[nodiscard]] Result<memory::PriorKnowledge> load(
      const memory::PriorOptions& options = {}) const {
    return memory::load_prior(scratch_.path(), options);
  }

  /// The instances of the only entity of this ID; empty where it was not loaded.
  static std::vector<ltm::Instance> instances_of(const memory::PriorKnowledge& knowledge,
                                                 std::string_view id) {
    for (const auto& [memory, commit] : knowledge.commits)
      for (const ltm::Snapshot& snapshot : commit.updates)
        if (snapshot.entity.to_string() == id) return snapshot.instances;
    return {};
  }

  [[nodiscard]] const std::filesystem::path& path() const { return scratch_.path(); }
  [[nodiscard]] std::filesystem::path operator/(const std::filesystem::path& name) const {
    return scratch_ / name;
  }

 private:
  ScratchDirectory scratch_;
};

}  // namespace engram::testing
