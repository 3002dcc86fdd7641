// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/libav.h"

extern "C" {
#include <libavutil/error.h>
#include <libavutil/log.h>
}

namespace engram::ltm::libav {

std::string describe(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(error, text, sizeof(text));
  return text;
}

void keep_quiet() {
  av_log_set_level(AV_LOG_QUIET);
}

}  // namespace engram::ltm::libav
