// SPDX-License-Identifier: Apache-2.0
#include "tests/server/robot/client_example.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ltm/core/file.h"
#include "tests/server/robot/running_server.h"

namespace engram::server {
namespace {

std::string text_of(const std::string& path) {
  const auto bytes = read_file(std::string(ENGRAM_SOURCE_DIR) + "/" + path);
  EXPECT_TRUE(bytes.ok()) << path;
  return bytes.ok() ? std::string(as_text(bytes->bytes())) : "";
}

TEST(ClientExample, Works) {
  testing::RunningServer running;
  running.with_store();
  running.start();
  const Status status = remember_a_cup(running.endpoint());
  EXPECT_TRUE(status.ok()) << status.to_string();
}

TEST(ClientExample, IsWhatThePageShows) {
  const std::string source = text_of("tests/server/robot/client_example.cpp");
  const std::string marker = "// [example]\n";
  const size_t begin = source.find(marker) + marker.size();
  const std::string example = source.substr(begin, source.find(marker, begin) - begin);
  EXPECT_THAT(text_of("docs/server.md"), ::testing::HasSubstr("```cpp\n" + example + "```"));
}

}  // namespace
}  // namespace engram::server
