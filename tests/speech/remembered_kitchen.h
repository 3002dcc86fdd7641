// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "memory/memory.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::speech::testing {

/// A moment of the first day, at 08:00 and so many seconds.
[[nodiscard]] Time second(double seconds, int day = 0);

/// One execution of a skill as a test tells it.
struct Done {
  std::string skill;
  double from = 0;
  double to = 0;
  int outcome = 1;  ///< 1 success, 2 failure, 3 stop.
  std::string thing{};
  std::string surface{};
  std::string hand{};
  std::string reason{};
  std::string plan{};        ///< The link to its plan; empty: none.
  std::string stopped_by{};  ///< The link to what stopped it; empty: nothing.
  int day = 0;
  bool is_ended = true;
};

/// A memory of a kitchen that is told what happened by hand, with the types of members that the
/// simulated kitchen has: a counter and a table; salt, tea and a red cup; a class of oil that was
/// never seen.
class RememberedKitchen {
 public:
  RememberedKitchen();

  [[nodiscard]] Memory& memory() { return *memory_; }
  [[nodiscard]] std::filesystem::path store() const { return scratch_.path() / "kitchen.engram"; }

  /// Returns the link to the words.
  std::string say(double at, const std::string& speaker, const std::string& text, int day = 0);
  /// A plan of look, navigate, pick, navigate, place.
  std::string plan(double at, const std::string& thing, const std::string& from,
                   const std::string& to, const std::string& words, int day = 0);
  /// Returns the event at which it started.
  std::string execute(const Done& done);
  void see(double at, const std::string& thing, double x, double y, double z, bool is_visible,
           const std::string& held_by = "", int day = 0);
  /// A counter 0.6 m deep and 4 m wide, centred at x and y.
  void put_surface(double at, const std::string& name, double x, double y);
  void stand(double at, double x, double y, double heading, int day = 0);

  /// Ada asks for salt on the table; the first grasp fails, the second does not; then Ben asks for
  /// tea on the table, and a grasp of it is stopped.
  void live_one_minute(int day = 0);

 private:
  void commit(const std::string& entity, Time time, idf::Dict value);

  ScratchDirectory scratch_;
  std::unique_ptr<Memory> memory_;
};

/// The day of live_one_minute, in other words: "2026-01-01".
inline constexpr const char* kFirstDay = "2026-01-01";

}  // namespace engram::speech::testing
