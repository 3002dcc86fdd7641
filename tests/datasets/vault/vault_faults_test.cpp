// SPDX-License-Identifier: Apache-2.0
// Every change of files that an export or the destruction of a key makes fails once, as by a kill
// and as on a full disk. The next run ends what was begun.
#include <fcntl.h>
#include <unistd.h>

#include <fstream>

#include "tests/datasets/vault/vault_fixture.h"
#include "tests/faults/faulty_files.h"
#include "tests/faults/run.h"

namespace engram::datasets::vault {
namespace {

class VaultFaults : public VaultFixture {
 protected:
  /// Runs `work` in a process of its own whose change number `call` fails. Returns how many it
  /// made.
  int64_t run_with_fault(int64_t call, int kind, const std::function<void()>& work) {
    const std::string counted = scratch_.path().string() + ".calls";
    ltm::faults::run_child([&] {
      faulty_files_watch(scratch_.path().c_str());
      faulty_files_fail(call, kind);
      work();
      std::ofstream(counted) << faulty_files_calls();
    });
    int64_t calls = 0;
    std::ifstream(counted) >> calls;
    std::filesystem::remove(counted);
    return calls;
  }

  void export_unwatched() { static_cast<void>(try_export().ok()); }

  void add_to_last_day() {
    const auto writer = *ltm::StoreWriter::open(store_, {});
    const Time late = time_at(kFirstDay + kDays - 1, kPerDay) - std::chrono::minutes(5);
    ASSERT_OK(writer->append({ltm::pack_snapshot(snapshot(arm(), late, 7))}, nullptr));
  }

  /// Keeps vault and keys as they are, to begin each case with them.
  void keep() {
    std::filesystem::copy(places_.vault, scratch_ / "vault.kept",
                          std::filesystem::copy_options::recursive);
    std::filesystem::copy(places_.keys, scratch_ / "keys.kept");
  }
  void bring_back_kept() {
    std::filesystem::remove_all(places_.vault);
    for (const char* suffix : {"", ".replacing", ".replaced"})
      std::filesystem::remove(places_.keys.string() + suffix);
    std::filesystem::copy(scratch_ / "vault.kept", places_.vault,
                          std::filesystem::copy_options::recursive);
    std::filesystem::copy(scratch_ / "keys.kept", places_.keys);
  }
};

constexpr std::array<int, 3> kKinds{kFaultDead, kFaultFull, kFaultBroken};

TEST_F(VaultFaults, AnExportThatFailsAnywhereIsEndedByTheNext) {
  make_store();
  exported("Body");
  add_to_last_day();
  keep();
  const auto all = answers(store_);
  const int64_t calls = run_with_fault(0, kFaultNone, [this] { export_unwatched(); });
  ASSERT_GT(calls, 20);
  for (int64_t call = 1; call <= calls; ++call)
    for (const int kind : kKinds) {
      SCOPED_TRACE(fmt::format("call {}, fault {}", call, kind));
      bring_back_kept();
      run_with_fault(call, kind, [this] { export_unwatched(); });
      // What is there reads as a part of the store: no orphan is taken for data.
      const auto part = check_vault(places_, {}, {});
      ASSERT_OK(part);
      for (const VaultFinding& finding : part->damaged) ADD_FAILURE() << finding.what;
      exported();
      const auto whole = checked();
      EXPECT_TRUE(whole.is_whole());
      EXPECT_EQ(whole.without_key + whole.remains, 0U);
      EXPECT_EQ(names().size(), 10U);
      for (const char* suffix : {".replacing", ".replaced"})
        EXPECT_FALSE(std::filesystem::exists(places_.keys.string() + suffix));
      // Each change by a rotation of cases, since importing takes longest.
      if (call % 5 != 0) continue;
      std::filesystem::remove_all(scratch_ / "back");
      imported(scratch_ / "back");
      EXPECT_EQ(answers(scratch_ / "back"), all);
    }
}

TEST_F(VaultFaults, AFirstExportThatFailsAnywhereIsEndedByTheNext) {
  make_store();
  const int64_t calls = run_with_fault(0, kFaultNone, [this] { export_unwatched(); });
  for (int64_t call = 1; call <= calls; ++call) {
    SCOPED_TRACE(call);
    std::filesystem::remove_all(places_.vault);
    for (const char* suffix : {"", ".replacing", ".replaced", ".lock"})
      std::filesystem::remove(places_.keys.string() + suffix);
    run_with_fault(call, kFaultDead, [this] { export_unwatched(); });
    EXPECT_EQ(exported().unread.size(), 0U);
    EXPECT_TRUE(checked().is_whole());
    EXPECT_EQ(checked().snapshots, 3U * kDays * kPerDay);
  }
}

TEST_F(VaultFaults, AKeyIsDestroyedOrAsBefore) {
  make_store();
  exported();
  keep();
  const std::string key = text_of(keys().find(camera(), kFirstDay)->key.bytes());
  const auto copied = [&key](int inode) {
    std::string bytes(1 << 20, '\0');
    const ssize_t size = ::pread(inode, bytes.data(), bytes.size(), 0);
    EXPECT_GT(size, 1000);
    return bytes.find(key) != std::string::npos;
  };
  const auto destroy = [this] {
    auto folder = VaultFolder::open_keys(places_);
    if (folder.ok()) static_cast<void>(folder->destroy({{camera(), kFirstDay}}, system_now()).ok());
  };
  const int64_t calls = run_with_fault(0, kFaultNone, destroy);
  ASSERT_GT(calls, 5);
  for (int64_t call = 1; call <= calls; ++call)
    for (const int kind : kKinds) {
      SCOPED_TRACE(fmt::format("call {}, fault {}", call, kind));
      bring_back_kept();
      // The blocks of the file that is replaced, which no name may lead to any more.
      const int old = ::open(places_.keys.c_str(), O_RDONLY | O_CLOEXEC);
      ASSERT_TRUE(copied(old));
      run_with_fault(call, kind, destroy);
      // The file may be gone already only if its key is.
      EXPECT_TRUE(checked().is_whole());
      destroy();
      EXPECT_TRUE(checked().is_whole());
      EXPECT_EQ(checked().destroyed, 1U);
      EXPECT_EQ(checked().remains, 0U);
      EXPECT_FALSE(copied(old)) << "though the first run was cut off";
      ::close(old);
      for (const auto& entry : std::filesystem::directory_iterator(scratch_.path()))
        if (entry.is_regular_file() && entry.path().filename() != "keys.kept") {
          EXPECT_EQ(content(entry.path()).find(key), std::string::npos) << entry.path();
        }
    }
}

}  // namespace
}  // namespace engram::datasets::vault
