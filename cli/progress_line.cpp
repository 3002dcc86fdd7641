// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "cli/command.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "ltm/core/time.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr auto kPlainLine = std::chrono::seconds(5);
constexpr int kBarCells = 24;
constexpr std::string_view kEllipsis = "...";
/// The beginning of the detail of a job that waits for the robot.
constexpr std::string_view kWaiting = "waiting: ";

size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string line_of(const Progress& progress, bool has_bar) {
  std::string line = printable(progress.what);
  if (progress.total > 0) {
    const double share =
        std::min(1.0, static_cast<double>(progress.done) / static_cast<double>(progress.total));
    const int cells = static_cast<int>(share * kBarCells);
    if (has_bar)
      line += fmt::format(" [{}{}]", std::string(static_cast<size_t>(cells), '#'),
                          std::string(static_cast<size_t>(kBarCells - cells), '.'));
    line += fmt::format(" {:3.0f} %", 100 * share);
  } else {
    line += fmt::format(" {}", reports::count_text(progress.done));
  }
  if (!progress.detail.empty()) line += "  " + printable(progress.detail);
  if (progress.seconds_left >= 0)
    line += fmt::format("  {} left", reports::seconds_text(progress.seconds_left));
  return line;
}

/// Returns a line that fits the width: first the bar is dropped, then the beginning of the name.
std::string fitting_line(Progress progress, size_t width) {
  progress.what = printable(progress.what);
  if (std::string line = line_of(progress, true); line.size() <= width) return line;
  const size_t needed = line_of(progress, false).size();
  if (needed > width && progress.what.size() > needed - width + kEllipsis.size())
    progress.what.replace(0, needed - width + kEllipsis.size(), kEllipsis);
  return line_of(progress, false).substr(0, width);
}

std::string json_line_of(const Progress& progress) {
  Json json{{"time", to_string(system_now()) + "Z"}, {"what", progress.what}};
  json["done"] = progress.done;
  json["total"] = progress.total > 0 ? Json(progress.total) : Json(nullptr);
  json["detail"] = progress.detail;
  json["seconds_left"] = progress.seconds_left >= 0
                             ? Json(std::round(progress.seconds_left * 10) / 10)
                             : Json(nullptr);
  return printable_json(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

ProgressLine::ProgressLine(ProgressForm form)
    : is_quiet_(form == ProgressForm::kNone || log::level() > log::Level::kInfo),
      is_json_(form == ProgressForm::kJson),
      is_redrawn_(!is_json_ && ::isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  finish();
}

ProgressSink ProgressLine::sink() {
  if (is_quiet_) return {};
  return [this](const Progress& progress) { show(progress); };
}

void ProgressLine::finish() {
  if (is_open_) fmt::print(stderr, "\n");
  is_open_ = false;
}

void ProgressLine::show(const Progress& progress) {
  const bool is_end = progress.total > 0 && progress.done >= progress.total;
  const bool is_waiting = progress.detail.starts_with(kWaiting);
  const bool is_new = progress.what != what_ || is_waiting != is_waiting_;
  const auto now = WallClock::now();
  if (!is_new && !is_end && now - last_ < (is_redrawn_ ? WallClock::duration(kRedraw) : kPlainLine))
    return;
  // The last line of the previous piece of work stays visible.
  if (is_new) finish();
  what_ = progress.what;
  is_waiting_ = is_waiting;
  last_ = now;
  if (is_json_) {
    fmt::print(stderr, "{}\n", json_line_of(progress));
    return;
  }
  if (!is_redrawn_) {
    fmt::print(stderr, "{}\n", line_of(progress, false));
    return;
  }
  // One column is left free, because a full line would wrap and could not be redrawn.
  fmt::print(stderr, "\r\033[K{}", fitting_line(progress, terminal_width() - 1));
  std::fflush(stderr);
  is_open_ = true;
}

}  // namespace engram::cli
