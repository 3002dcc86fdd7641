// SPDX-License-Identifier: Apache-2.0
#include "cli/child_pipe.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace engram::cli {

Status ChildPipe::open() {
  if (::pipe2(ends_.data(), O_CLOEXEC) != 0) return unavailable("pipe: {}", std::strerror(errno));
  return {};
}

void ChildPipe::close() {
  close_end(0);
  close_end(1);
}

void ChildPipe::close_end(size_t end) {
  if (ends_[end] >= 0) ::close(ends_[end]);
  ends_[end] = -1;
}

bool ChildPipe::has_bytes() const {
  pollfd one{read_end(), POLLIN, 0};
  return ::poll(&one, 1, 0) > 0;
}

void ChildPipe::read_into(std::string& text) {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(read_end(), bytes.data(), bytes.size());
  if (count > 0) text.append(bytes.data(), static_cast<size_t>(count));
  if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) close_end(0);
}

void ChildLines::read(ChildPipe& pipe, const std::function<void(const std::string&)>& tell) {
  pipe.read_into(text_);
  for (size_t end = 0; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1))
    tell(text_.substr(0, end));
  if (!pipe.is_open() && !text_.empty()) tell(std::exchange(text_, {}));
}

}  // namespace engram::cli
