// SPDX-License-Identifier: Apache-2.0
// crash_night KILLS [SEED]: runs `engram consolidate` on a small rendered scene and kills it at
// random moments (SIGKILL). After each kill: `engram check` finds nothing wrong, and every recorded
// snapshot is there bit for bit. Jobs that come through make the very model that one makes which
// was never killed. Then what was consolidated fades, in three steps with as many kills: nothing is
// wrong, every moment is there, and in the end all of it has faded. Prints a table; exit code 1
// where anything is not so.
#include <charconv>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "ltm/core/log.h"
#include "ltm/idf/binary.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/checksum.h"
#include "ltm/store/store_reader.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using Clock = std::chrono::steady_clock;
/// What a store holds, by name: checksums of recorded snapshots, or of model files.
using Content = std::map<std::string, uint64_t>;

struct Row {
  int kills = 0;
  int failures = 0;
};

class Night {
 public:
  explicit Night(uint32_t seed) : random_(seed) {
    const auto recording = make_recording(scratch_.path(), 8);
    ENGRAM_CHECK(run_engram(import_arguments(recording, store_)).exit_code == 0, "no import");
    recorded_ = recorded();
    const auto start = Clock::now();
    const RunResult whole = run_engram(consolidate_);
    ENGRAM_CHECK(whole.exit_code == 0, "consolidate failed: {}", whole.err);
    longest_ms_ = milliseconds_since(start);
    models_ = models();
    ENGRAM_CHECK(recorded_.size() == 80 && models_.size() == 2, "an unexpected scene");
  }

  /// Kills so many jobs, then lets one come through.
  int run(int kills) {
    const auto start = Clock::now();
    for (int killed = 0; killed < kills;) {
      const RunResult result =
          run_engram_and_kill(consolidate_, std::uniform_int_distribution(0, longest_ms_)(random_));
      killed += result.exit_code < 0 ? 1 : 0;
      look_at(result);
    }
    look_at(run_engram(consolidate_));
    keep();
    for (const char* step : {"psnr: 34", "psnr: 28", "form: gist"}) fade(step, (kills + 2) / 3);
    print(kills, std::chrono::duration<double>(Clock::now() - start).count());
    return failures_ == 0 ? 0 : 1;
  }

 private:
  [[nodiscard]] Content recorded() const {
    Content found;
    auto reader = *ltm::StoreReader::open(store_);
    for (const ltm::MemoryId& entity : reader->entities()) {
      for (const ltm::SnapshotEntry& entry : **reader->index(entity)) {
        if (!entry.recorded) continue;
        const ltm::Snapshot snapshot = *reader->read_recorded(entity, entry);
        uint64_t sum = 0;
        for (const ltm::Instance& instance : snapshot.instances)
          sum = sum * 31 + ltm::checksum(*idf::encode(instance.data));
        found[entity.to_string() + to_string(entry.time)] = sum;
      }
    }
    return found;
  }

  [[nodiscard]] Content models() const {
    Content found;
    const ltm::Manifest manifest = *ltm::read_manifest(store_);
    for (const ltm::ModelInfo& model : manifest.models)
      found[model.entity.to_string()] =
          *ltm::checksum_of_file(std::filesystem::path(store_) / model.file);
    return found;
  }

  /// "train", "encode", or what was there before.
  static std::string phase_of(const RunResult& result) {
    std::string phase = "start";
    std::istringstream lines(result.err);
    for (std::string line; std::getline(lines, line);) {
      const auto json = nlohmann::json::parse(line, nullptr, false);
      if (json.is_object()) phase = json.at("what").get<std::string>();
    }
    return phase.substr(0, phase.find(' '));
  }

  void look_at(const RunResult& result) {
    resumed_ += result.err.find("training goes on from a checkpoint") != std::string::npos ? 1 : 0;
    std::vector<std::string> problems;
    if (result.exit_code == 0) {
      ++finished_;
      if (models() != models_) problems.emplace_back("a model differs from that of a whole job");
    } else if (result.exit_code != -9) {
      problems.push_back(fmt::format("exit code {}: {}", result.exit_code, result.err));
    }
    const RunResult check = run_engram({"check", store_});
    if (check.exit_code != 0) problems.push_back("check: " + check.out + check.err);
    if (recorded() != recorded_) problems.emplace_back("a recorded snapshot is not what it was");
    for (const std::string& problem : problems) fmt::print(stderr, "{}\n", problem);
    failures_ += problems.empty() ? 0 : 1;
    if (result.exit_code == 0) return;
    Row& row = rows_[phase_of(result)];
    ++row.kills;
    row.failures += problems.empty() ? 0 : 1;
  }

  /// Every moment of the camera, whatever form it has.
  [[nodiscard]] std::vector<Time> moments() const {
    std::vector<Time> found;
    auto reader = *ltm::StoreReader::open(store_);
    for (const ltm::SnapshotEntry& entry : **reader->index(*ltm::MemoryId::parse(kCamera)))
      found.push_back(entry.time);
    return found;
  }

  /// Lets all images fade by one step, with so many kills. Where a job comes through, all that it
  /// did is undone, so that the next kills find work.
  void fade(const std::string& step, int kills) {
    const std::string config = scratch_.path() / "fade.yaml";
    std::ofstream(config)
        << "forget:\n  protect: {newest: 0}\n  fade:\n    - {match: Vision, after: 0s, " << step
        << "}\n";
    const std::vector<std::string> forget{"forget", store_, "--config", config, "--yes"};
    const std::vector<Time> before = moments();
    const auto start = Clock::now();
    for (int killed = 0, longest_ms = 0; killed < kills;) {
      const RunResult result =
          longest_ms == 0
              ? run_engram(forget)
              : run_engram_and_kill(forget, std::uniform_int_distribution(0, longest_ms)(random_));
      if (longest_ms == 0) longest_ms = milliseconds_since(start);
      look_at_faded(result, before, step);
      killed += result.exit_code < 0 ? 1 : 0;
      if (result.exit_code == 0) restore();
    }
    const RunResult last = run_engram(forget);
    look_at_faded(last, before, step);
    if (last.exit_code != 0 || recorded().size() != recorded_.size() - before.size())
      fail(step, "not everything has faded: " + last.err);
    keep();
  }

  /// Keeps the store as it is, for restore().
  void keep() const {
    std::filesystem::remove_all(kept_);
    std::filesystem::copy(store_, kept_, std::filesystem::copy_options::recursive);
  }

  void restore() const {
    std::filesystem::remove_all(store_);
    std::filesystem::copy(kept_, store_, std::filesystem::copy_options::recursive);
  }

  static int milliseconds_since(Clock::time_point start) {
    return static_cast<int>(
        std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start).count());
  }

  void look_at_faded(const RunResult& result, const std::vector<Time>& before,
                     const std::string& step) {
    Row& row = rows_["fade, " + step];
    row.kills += result.exit_code < 0 ? 1 : 0;
    if (result.exit_code != 0 && result.exit_code != -9)
      fail(step, fmt::format("exit code {}: {}", result.exit_code, result.err));
    const RunResult check = run_engram({"check", store_});
    if (check.exit_code != 0) fail(step, "check: " + check.out + check.err);
    if (moments() != before) fail(step, "a moment is gone");
  }

  void fail(const std::string& step, const std::string& what) {
    fmt::print(stderr, "fade, {}: {}\n", step, what);
    ++failures_;
    ++rows_["fade, " + step].failures;
  }

  void print(int kills, double seconds) const {
    fmt::print("{:<16} {:>6} {:>18}\n", "killed during", "kills", "anything was wrong");
    for (const auto& [phase, row] : rows_)
      fmt::print("{:<16} {:>6} {:>18}\n", phase, row.kills, row.failures);
    fmt::print(
        "{} jobs killed, {} went on from a checkpoint, {} came through with the same models, "
        "{} looks found something wrong, {:.0f} s\n",
        kills, resumed_, finished_, failures_, seconds);
  }

  ScratchDirectory scratch_;
  std::string store_ = scratch_.path() / "robot.engram";
  std::string kept_ = scratch_.path() / "kept.engram";
  std::vector<std::string> consolidate_{"consolidate", store_,       "--representation",
                                        "latents",     "--steps",    "60",
                                        "--threads",   "1",          "--force",
                                        "--width",     "32",         "--checkpoint-every",
                                        "100ms",       "--progress", "json",
                                        "--anew"};
  std::mt19937 random_;
  int longest_ms_ = 0;
  Content recorded_;
  Content models_;
  std::map<std::string, Row> rows_;
  int resumed_ = 0;
  int finished_ = 0;
  int failures_ = 0;
};

int main_of(int count, char** arguments) {
  const auto number = [&](int at, int fallback) {
    int value = fallback;
    const std::string_view text = at < count ? arguments[at] : "";
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  };
  return Night(static_cast<uint32_t>(number(2, 1))).run(number(1, 100));
}

}  // namespace
}  // namespace engram::cli

int main(int count, char** arguments) {
  return engram::cli::main_of(count, arguments);
}
