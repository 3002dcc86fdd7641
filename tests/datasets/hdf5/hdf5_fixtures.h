// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numeric>

#include "ltm/h5/h5.h"
#include "tests/datasets/hdf5/round_trip.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets::testing {

inline h5::Attribute text_attribute(const std::string& text) {
  return {{h5::Kind::kText}, {}, {}, {text}};
}

/// Bytes 0, 1, 2, ... as rows of an array.
inline Status write_rows(h5::File& file, const std::string& path, const h5::ArrayInfo& info) {
  std::vector<std::byte> bytes(info.rows() * info.row_bytes());
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i % 64);
  ENGRAM_RETURN_IF_ERROR(file.create_array(path, info));
  ENGRAM_RETURN_IF_ERROR(file.write_array_rows(path, 0, bytes));
  return file.finish_array(path);
}

/// Two small demonstrations as robomimic lays them out.
inline Status write_robomimic(const std::filesystem::path& path, const std::string& env_args) {
  using h5::Kind;
  using h5::Type;
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path, h5::Audience::kEverybody));
  ENGRAM_RETURN_IF_ERROR(file.make_group("/data"));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/data", "env_args", text_attribute(env_args)));
  for (const auto& [demo, rows] : {std::pair<const char*, uint64_t>{"demo_0", 4}, {"demo_1", 3}}) {
    const std::string group = std::string("/data/") + demo;
    ENGRAM_RETURN_IF_ERROR(
        write_rows(file, group + "/actions", {{Kind::kNumber, Type::kFloat64}, {rows, 7}}));
    ENGRAM_RETURN_IF_ERROR(
        write_rows(file, group + "/dones", {{Kind::kNumber, Type::kInt64}, {rows}}));
    ENGRAM_RETURN_IF_ERROR(write_rows(file, group + "/obs/robot0_joint_pos",
                                      {{Kind::kHalf, Type::kFloat32}, {rows, 2}}));
    ENGRAM_RETURN_IF_ERROR(
        write_rows(file, group + "/obs/front_image", {{}, {rows, 4, 6, 3}, 2, 4}));
    ENGRAM_RETURN_IF_ERROR(
        write_rows(file, group + "/next_obs/front_image", {{}, {rows, 4, 6, 3}, 2, 4}));
    ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "num_samples", int64_t(rows)));
    ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "model_file", text_attribute("<mujoco/>")));
  }
  return file.close();
}

constexpr const char* kEnvArgs = R"({"env_kwargs": {"control_freq": 10}})";

/// One episode as ALOHA lays it out.
inline Status write_aloha(const std::filesystem::path& path, uint64_t rows) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path, h5::Audience::kEverybody));
  const h5::Element number{h5::Kind::kNumber, h5::Type::kFloat32};
  ENGRAM_RETURN_IF_ERROR(write_rows(file, "/action", {number, {rows, 14}}));
  ENGRAM_RETURN_IF_ERROR(write_rows(file, "/observations/qpos", {number, {rows, 14}}));
  ENGRAM_RETURN_IF_ERROR(write_rows(file, "/observations/images/top", {{}, {rows, 16, 16, 3}, 1}));
  return file.close();
}

}  // namespace engram::datasets::testing
