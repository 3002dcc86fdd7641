// SPDX-License-Identifier: Apache-2.0
#include "server/kitchen/body_messages.h"

#include <array>

#include "tests/fuzz/fuzz_check.h"

namespace engram::server {
namespace {

/// What can be read writes a message that reads to one that is written alike.
template <typename Message, typename Read>
void check_message(std::string_view text, Read read) {
  Message message;
  if (!message.ParseFromArray(text.data(), static_cast<int>(text.size()))) return;
  const auto value = read(message);
  if (!value.ok()) {
    ENGRAM_CHECK(value.status().code() == StatusCode::kInvalidArgument, "{}",
                 value.status().message());
    return;
  }
  const auto written = to_message(*value);
  const auto again = read(written);
  ENGRAM_CHECK(again.ok(), "{}", again.status().message());
  ENGRAM_CHECK(to_message(*again).SerializeAsString() == written.SerializeAsString(),
               "reads as another value");
}

}  // namespace
}  // namespace engram::server

/// Whatever bytes another process sends over the bus of a robot. The first one says what they are.
int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace engram;
  using namespace engram::server;
  const std::string_view text = fuzzed_text(bytes, size);
  if (text.empty()) return 0;
  const std::string_view rest = text.substr(1);
  constexpr std::array kReaders{
      +[](std::string_view one) { check_message<v1::BodyDescription>(one, read_description); },
      +[](std::string_view one) { check_message<v1::BodyState>(one, read_state); },
      +[](std::string_view one) { check_message<v1::BodyDrawReply>(one, read_picture); },
      +[](std::string_view one) { check_message<v1::BodyCommandRequest>(one, read_command); },
      +[](std::string_view one) { check_message<v1::BodyStepRequest>(one, read_step); },
      +[](std::string_view one) { check_message<v1::BodyPassRequest>(one, read_wish); }};
  kReaders.at(static_cast<unsigned char>(text.front()) % kReaders.size())(rest);
  return 0;
}
