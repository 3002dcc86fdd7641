// SPDX-License-Identifier: Apache-2.0
#include "server/robot/host_reader.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

constexpr uint64_t kKiB = 1024;

/// A machine whose files the test writes.
class HostReaderTest : public ::testing::Test {
 protected:
  HostReaderTest() : reader_({.root = scratch_.path(), .disks = {}}) {
    write("proc/stat", "cpu  100 0 100 700 100 0 0 0 0 0\ncpu0 100 0 100 700 100 0 0 0 0 0\n");
    write("proc/meminfo", "MemTotal:       1000 kB\nMemFree:  1 kB\nMemAvailable:    400 kB\n");
    write("proc/self/status", "Name:\ttest\nVmRSS:\t     77 kB\n");
  }

  void write(const std::string& name, std::string_view text) {
    std::filesystem::create_directories((scratch_ / name).parent_path());
    overwrite_file(scratch_ / name, std::as_bytes(std::span(text)));
  }

  void group(const std::string& name, std::string_view limit, std::string_view used,
             std::string_view idle = "0") {
    const std::string folder = "sys/fs/cgroup/" + name;
    write(folder + "/memory.max", fmt::format("{}\n", limit));
    write(folder + "/memory.current", fmt::format("{}\n", used));
    write(folder + "/memory.stat", fmt::format("anon 5\ninactive_file {}\n", idle));
  }

  ScratchDirectory scratch_;
  HostReader reader_;
};

TEST_F(HostReaderTest, ReadsAMachineWithoutPressureAndGroups) {
  const auto state = reader_.read();
  ASSERT_OK(state);
  EXPECT_EQ(state->ram, (RamState{1000 * kKiB, 400 * kKiB}));
  EXPECT_EQ(state->process_bytes, 77 * kKiB);
  EXPECT_EQ(state->cpu_share, std::nullopt);
  EXPECT_EQ(state->group_ram, std::nullopt);
  EXPECT_EQ(state->memory_pressure, std::nullopt);
}

TEST_F(HostReaderTest, MeasuresTheCpuBetweenTwoReadings) {
  ASSERT_OK(reader_.read());
  write("proc/stat", "cpu  140 5 120 715 105 5 5 5 9 9\n");
  EXPECT_EQ(reader_.read()->cpu_share, 0.8);
  EXPECT_EQ(reader_.read()->cpu_share, std::nullopt) << "no time passed";
  write("proc/stat", "cpu  140 5 120 714 105 5 6 15 9 9\n");
  EXPECT_EQ(reader_.read()->cpu_share, 1.0) << "a counter fell";
}

TEST_F(HostReaderTest, ReadsPressureWhereTheKernelMeasuresIt) {
  write("proc/pressure/cpu", "some avg10=1.50 avg60=2.00 avg300=3.00 total=12345\n");
  write("proc/pressure/memory",
        "some avg10=12.25 avg60=0.00 avg300=0.00 total=1\nfull avg10=3.00 avg60=0.00 total=1\n");
  const auto state = reader_.read();
  ASSERT_OK(state);
  EXPECT_EQ(state->cpu_pressure, (Pressure{1.5, std::nullopt}));
  EXPECT_EQ(state->memory_pressure, (Pressure{12.25, 3.0}));
  EXPECT_EQ(state->io_pressure, std::nullopt);
}

TEST_F(HostReaderTest, FindsTheTightestOfTheGroupsAroundIt) {
  write("proc/self/cgroup", "1:name=systemd:/x\n0::/robot/server\n");
  group("robot/server", "max", "10");
  EXPECT_EQ(reader_.read()->group_ram, std::nullopt);
  group("robot", "1000", "600", "100");
  EXPECT_EQ(reader_.read()->group_ram, (RamState{1000, 500}));
  group("robot/server", "300", "20");
  EXPECT_EQ(reader_.read()->group_ram, (RamState{300, 280}));
  group("", "2000", "1990");
  EXPECT_EQ(reader_.read()->group_ram, (RamState{2000, 10}));
  group("", "2000", "2500");
  EXPECT_EQ(reader_.read()->group_ram, (RamState{2000, 0}));
}

TEST_F(HostReaderTest, KnowsItsGroupInAContainerAndOutsideOfItsNameSpace) {
  group("", "1000", "600");
  write("proc/self/cgroup", "0::/\n");
  EXPECT_EQ(reader_.read()->group_ram, (RamState{1000, 400}));
  write("proc/self/cgroup", "0::/../../elsewhere\n");
  EXPECT_EQ(reader_.read()->group_ram, (RamState{1000, 400}));
  write("proc/self/cgroup", "5:memory:/old\n");
  EXPECT_EQ(reader_.read()->group_ram, std::nullopt) << "control groups of the first version";
}

TEST_F(HostReaderTest, ReadsDisksAndDoesWithoutThoseThatAreGone) {
  HostReader reader({.root = scratch_.path(), .disks = {scratch_.path(), scratch_ / "unplugged"}});
  const auto state = reader.read();
  ASSERT_OK(state);
  ASSERT_EQ(state->disks.size(), 2u);
  EXPECT_GT(*state->disks[0].total_bytes, 0u);
  EXPECT_LE(*state->disks[0].free_bytes, *state->disks[0].total_bytes);
  EXPECT_EQ(state->disks[1].total_bytes, std::nullopt);
}

TEST_F(HostReaderTest, NamesTheFileThatIsMissingOrDamaged) {
  const auto refuses = [&](const std::string& file, std::string_view text, std::string_view fine) {
    write(file, text);
    EXPECT_FAILS(reader_.read(), StatusCode::kDataLoss, file);
    write(file, fine);
  };
  const std::string stat = "cpu  1 1 1 1 1 1 1 1\n";
  refuses("proc/stat", "", stat);
  refuses("proc/stat", "cpu  1 2 3\n", stat);
  refuses("proc/stat", "cpu  1 2 3 -4 5 6 7 8\n", stat);
  refuses("proc/stat", "cpu  1 2 3 99999999999999999999 5 6 7 8\n", stat);
  const std::string meminfo = "MemTotal: 10 kB\nMemAvailable: 5 kB\n";
  refuses("proc/meminfo", "MemTotal: 10 kB\n", meminfo);
  refuses("proc/meminfo", "MemTotal: 0 kB\nMemAvailable: 5 kB\n", meminfo);
  refuses("proc/meminfo", "MemTotal: 10 MB\nMemAvailable: 5 kB\n", meminfo);
  refuses("proc/meminfo", "MemTotal: 99999999999999999 kB\nMemAvailable: 5 kB\n", meminfo);
  refuses("proc/pressure/io", "some avg10=x\n", "some avg10=1.00 avg60=1.00\n");
  refuses("proc/pressure/io", "some avg10=101\n", "some avg10=1.00 avg60=1.00\n");
  refuses("proc/pressure/io", "full avg10=1\n", "some avg10=1.00 avg60=1.00\n");
  write("proc/self/cgroup", "0::/a\n");
  group("a", "10", "5");
  refuses("sys/fs/cgroup/a/memory.max", "lots\n", "10\n");
  refuses("sys/fs/cgroup/a/memory.current", "\n", "5\n");
  refuses("proc/self/status", "Name: test\n", "VmRSS: 1 kB\n");
  EXPECT_OK(reader_.read());
  std::filesystem::remove(scratch_ / "proc/meminfo");
  EXPECT_FAILS(reader_.read(), StatusCode::kNotFound, "proc/meminfo");
}

TEST_F(HostReaderTest, ReadsNoMoreThanItNeeds) {
  write("proc/stat", "cpu  1 1 1 1 1 1 1 1\n" + std::string(10'000'000, 'x'));
  EXPECT_OK(reader_.read());
}

TEST(HostReader, ReadsThisMachine) {
  HostReader reader({.root = "/", .disks = {"/"}});
  const auto state = reader.read();
  ASSERT_OK(state);
  EXPECT_GT(state->ram.total_bytes, state->ram.available_bytes);
  EXPECT_GT(state->process_bytes, 0u);
}

}  // namespace
}  // namespace engram::server
