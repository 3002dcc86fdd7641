// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/program_detector.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "ltm/core/buffer.h"
#include "ltm/core/line_process.h"
#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/core/printable.h"
#include "ltm/idf/strict_json.h"

namespace engram::ltm {

namespace {

constexpr Duration kFirstPause = std::chrono::milliseconds(100);
constexpr Duration kLongestPause = std::chrono::seconds(30);
/// What it has to end by itself when its input ends.
constexpr Duration kGrace = std::chrono::milliseconds(300);
/// Bytes of an answer that an error shows.
constexpr size_t kShownBytes = 80;
constexpr size_t kMaxAnswer = size_t{1} << 20;

Status check_ready(const std::string& line) {
  const auto json = idf::parse_json(line, 2);
  if (json.ok() && json->is_object() && json->size() == 1 && json->contains("ready") &&
      (*json)["ready"] == true)
    return {};
  return failed_precondition("found '{}', needs {{\"ready\": true}} first",
                             printable(line.substr(0, kShownBytes)));
}

std::string header_of(const DetectorImage& image, uint64_t number) {
  const nlohmann::ordered_json json{{"image", number},
                                    {"entity", image.entity},
                                    {"member", image.member},
                                    {"time_ns", to_ns(image.time)},
                                    {"width", image.width},
                                    {"height", image.height},
                                    {"channels", image.channels},
                                    {"bytes", image.pixels.size()}};
  // Names are UTF-8, but paths of members come from outside as they are.
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

struct ProgramDetector::State {
  enum class Phase : uint8_t {
    kStarting,  ///< The thread has the process.
    kReady,     ///< Whoever holds the mutex has it.
    kBroken,    ///< The thread has it, and kills it.
  };

  explicit State(const Options& given) : options(given) {}

  const Options options;
  mutable Mutex mutex;
  StoppableCondition changed;
  Phase phase ENGRAM_GUARDED_BY(mutex) = Phase::kStarting;
  Status why ENGRAM_GUARDED_BY(mutex);  ///< Why it is not ready.
  uint64_t starts ENGRAM_GUARDED_BY(mutex) = 0;
  uint64_t images ENGRAM_GUARDED_BY(mutex) = 0;  ///< That were sent: the number of the last one.
  Duration pause ENGRAM_GUARDED_BY(mutex) = kFirstPause;
  bool is_open ENGRAM_GUARDED_BY(mutex) = false;  ///< Somebody has this detector.
  /// Used by one side at a time, see Phase.
  LineProcess process;
  std::jthread thread;  ///< The last member, so it ends first.

  Status begin(const std::stop_token& stop) {
    ENGRAM_RETURN_IF_ERROR(process.start(
        options.command,
        {.has_errors = false, .life = ChildLife::kWithThread, .max_line = kMaxAnswer}));
    ENGRAM_ASSIGN_OR_RETURN(const std::string line,
                            process.read_line(steady_now() + options.start_timeout, stop));
    return check_ready(line);
  }

  /// Starts the program, and starts it again whenever it is broken.
  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const Status status = begin(stop);
      {
        const MutexLock lock(mutex);
        ++starts;
        why = status;
        phase = status.ok() ? Phase::kReady : Phase::kBroken;
        changed.notify_all();
        changed.wait(mutex, stop,
                     [this]() ENGRAM_REQUIRES(mutex) { return phase != Phase::kReady; });
      }
      process.end(stop.stop_requested() ? kGrace : Duration(0));
      const MutexLock lock(mutex);
      if (stop.stop_requested()) break;
      if (is_open)
        log::warning("detector '{}': {}; it is started again in {}", options.command.front(),
                     why.message(), to_string(pause));
      changed.wait_for(mutex, stop, std::exchange(pause, std::min(2 * pause, kLongestPause)),
                       [] { return false; });
      phase = Phase::kStarting;
    }
  }

  Result<std::vector<Box>> ask(const DetectorImage& image) ENGRAM_REQUIRES(mutex) {
    const SteadyTime until = steady_now() + options.timeout;
    const std::string header = header_of(image, ++images);
    ENGRAM_RETURN_IF_ERROR(process.write(engram::as_bytes(header), until));
    ENGRAM_RETURN_IF_ERROR(process.write(std::as_bytes(image.pixels), until));
    ENGRAM_ASSIGN_OR_RETURN(const std::string line, process.read_line(until));
    auto boxes = parse_boxes(line, images);
    if (boxes.ok()) return boxes;
    return unavailable("its answer '{}': {}", printable(line.substr(0, kShownBytes)),
                       boxes.status().message());
  }
};

Status ProgramDetector::Options::validate() const {
  if (command.empty() || command.front().empty())
    return invalid_argument("program: needs a program and its arguments, as a list");
  const bool has_zero = std::ranges::any_of(
      command, [](const std::string& word) { return word.find('\0') != std::string::npos; });
  if (has_zero) return invalid_argument("program: found a zero byte in its arguments");
  if (timeout <= Duration(0) || timeout > std::chrono::hours(1))
    return invalid_argument("timeout: found {}, needs more than 0s and at most 1h",
                            to_string(timeout));
  if (start_timeout <= Duration(0)) return invalid_argument("start_timeout: needs more than 0s");
  return {};
}

ProgramDetector::ProgramDetector(std::unique_ptr<State> state) : state_(std::move(state)) {}
ProgramDetector::~ProgramDetector() = default;

Result<std::unique_ptr<Detector>> ProgramDetector::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  auto state = std::make_unique<State>(options);
  State& running = *state;
  state->thread = std::jthread([&running](const std::stop_token& stop) { running.run(stop); });
  const std::stop_token never;
  Status status;
  {
    const MutexLock lock(state->mutex);
    state->changed.wait(state->mutex, never, [&running]() ENGRAM_REQUIRES(running.mutex) {
      return running.phase != State::Phase::kStarting;
    });
    status = state->why;
    state->is_open = status.ok();
  }
  if (status.code() == StatusCode::kNotFound) return status.with_context("detector 'program'");
  if (!status.ok())
    return failed_precondition("detector 'program': '{}': {}", options.command.front(),
                               status.message());
  return std::unique_ptr<Detector>(new ProgramDetector(std::move(state)));
}

Result<std::vector<Box>> ProgramDetector::find(const DetectorImage& image) {
  if (image.pixels.empty()) return std::vector<Box>();
  State& state = *state_;
  const MutexLock lock(state.mutex);
  if (state.phase != State::Phase::kReady)
    return unavailable("detector '{}' is not ready", state.options.command.front());
  auto boxes = state.ask(image);
  if (boxes.ok()) {
    state.pause = kFirstPause;
    return boxes;
  }
  // Its answer may still come, and would be taken for that of the next image.
  state.why = boxes.status();
  state.phase = State::Phase::kBroken;
  state.changed.notify_all();
  return boxes.status().with_context("detector 'program'");
}

Status ProgramDetector::wait_ready(const std::stop_token& stop) {
  State& state = *state_;
  // The longest pause, and a start.
  const Duration patience = kLongestPause + state.options.start_timeout + std::chrono::seconds(1);
  const MutexLock lock(state.mutex);
  state.changed.wait_for(state.mutex, stop, patience, [&state]() ENGRAM_REQUIRES(state.mutex) {
    return state.phase == State::Phase::kReady;
  });
  if (state.phase == State::Phase::kReady) return {};
  const std::string& program = state.options.command.front();
  if (stop.stop_requested()) return cancelled("detector '{}': stopped", program);
  return unavailable("detector '{}' is not ready again after {}: {}", program, to_string(patience),
                     state.why.message());
}

uint64_t ProgramDetector::starts() const {
  const MutexLock lock(state_->mutex);
  return state_->starts;
}

}  // namespace engram::ltm
