// SPDX-License-Identifier: Apache-2.0
#include "cli/confirm.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "cli/interrupt.h"

namespace engram::cli {

bool is_confirmed(const std::string& question) {
  fmt::print(stderr, "{} [y/N] ", question);
  std::fflush(stderr);
  constexpr int kLook_ms = 100;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  // The interrupt thread takes the signal, so a blocking read would not see Ctrl-C.
  while (::poll(&input, 1, kLook_ms) == 0)
    if (interrupt_token().stop_requested()) return false;
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "y" || answer == "yes";
}

}  // namespace engram::cli
