// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/metric_registry.h"

#include <limits>
#include <thread>

#include "tests/ltm/expect_status.h"
#include "tests/server/rpc/prometheus_text.h"

namespace engram::server {
namespace {

using engram::testing::read_prometheus_text;

TEST(MetricRegistry, WritesWhatPrometheusReads) {
  MetricRegistry registry;
  registry.counter("engram_reads_total", "Snapshots given out.").add(3);
  registry.gauge("engram_memory_bytes", "Plain bytes in RAM.").set(1.5e9);
  auto& commits = registry.counters({"engram_commits_total", "Commits.", {"memory", "code"}});
  commits.with({"Vision", "ok"}).add(7);
  commits.with({"Robot", "invalid argument"}).add();
  auto& seconds = registry.histogram("engram_query_seconds", "Time to answer.", {0.001, 0.1});
  seconds.observe(0.05);
  seconds.observe(0.25);
  EXPECT_EQ(registry.to_text(),
            "# HELP engram_commits_total Commits.\n"
            "# TYPE engram_commits_total counter\n"
            "engram_commits_total{memory=\"Robot\",code=\"invalid argument\"} 1\n"
            "engram_commits_total{memory=\"Vision\",code=\"ok\"} 7\n"
            "# HELP engram_memory_bytes Plain bytes in RAM.\n"
            "# TYPE engram_memory_bytes gauge\n"
            "engram_memory_bytes 1500000000\n"
            "# HELP engram_query_seconds Time to answer.\n"
            "# TYPE engram_query_seconds histogram\n"
            "engram_query_seconds_bucket{le=\"0.001\"} 0\n"
            "engram_query_seconds_bucket{le=\"0.1\"} 1\n"
            "engram_query_seconds_bucket{le=\"+Inf\"} 2\n"
            "engram_query_seconds_sum 0.3\n"
            "engram_query_seconds_count 2\n"
            "# HELP engram_reads_total Snapshots given out.\n"
            "# TYPE engram_reads_total counter\n"
            "engram_reads_total 3\n");
  const auto families = read_prometheus_text(registry.to_text());
  ASSERT_OK(families);
  EXPECT_EQ(families->at("engram_commits_total").samples[1].labels.at("memory"), "Vision");
}

TEST(MetricRegistry, WritesNothingWhereThereIsNothing) {
  MetricRegistry registry;
  EXPECT_EQ(registry.to_text(), "");
  registry.counters({"a_total", "", {"x"}});
  EXPECT_EQ(registry.to_text(), "# HELP a_total \n# TYPE a_total counter\n");
}

TEST(MetricRegistry, EscapesWhatComesFromOutside) {
  MetricRegistry registry;
  const std::string nasty = "\"}\\ 1\n# TYPE x counter\n\\n{a=\"b\",";
  registry.counters({"a_total", "back\\slash\nand line", {"memory"}}).with({nasty}).add();
  const auto families = read_prometheus_text(registry.to_text());
  ASSERT_OK(families);
  ASSERT_EQ(families->size(), 1u);
  EXPECT_EQ(families->at("a_total").help, "back\\slash\nand line");
  EXPECT_EQ(families->at("a_total").samples[0].labels.at("memory"), nasty);
}

TEST(MetricRegistry, WritesNumbersThatAreNone) {
  MetricRegistry registry;
  registry.gauge("a", "").set(std::numeric_limits<double>::quiet_NaN());
  registry.gauge("b", "").set(std::numeric_limits<double>::infinity());
  registry.gauge("c", "").set(-std::numeric_limits<double>::infinity());
  registry.gauge("d", "").set(-1e-300);
  const std::string text = registry.to_text();
  for (const char* line : {"\na NaN\n", "\nb +Inf\n", "\nc -Inf\n", "\nd -1e-300\n"})
    EXPECT_THAT(text, ::testing::HasSubstr(line));
  EXPECT_OK(read_prometheus_text(text));
}

TEST(MetricRegistry, GivesTheSameMetricForTheSameName) {
  MetricRegistry registry;
  EXPECT_EQ(&registry.counter("a_total", "x"), &registry.counter("a_total", "x"));
  auto& family = registry.histograms({"b_seconds", "x", {"method"}}, {1, 2});
  EXPECT_EQ(&family.with({"Commit"}),
            &registry.histograms({"b_seconds", "x", {"method"}}, {1, 2}).with({"Commit"}));
  EXPECT_NE(&family.with({"Commit"}), &family.with({"Query"}));
}

TEST(MetricRegistry, BoundsWhatLabelsFromOutsideTake) {
  using Family = MetricFamily<Counter>;
  MetricRegistry registry;
  auto& family = registry.counters({"a_total", "x", {"one", "two"}});
  for (size_t i = 0; i < 3 * Family::kMaxSeries; ++i) family.with({std::to_string(i), "x"}).add();
  const auto families = read_prometheus_text(registry.to_text());
  ASSERT_OK(families);
  EXPECT_EQ(families->at("a_total").samples.size(), Family::kMaxSeries + 1);
  EXPECT_EQ(family.with({"other", "other"}).value(), 2 * Family::kMaxSeries);
  EXPECT_EQ(family.with({"7", "x"}).value(), 1u);
}

TEST(MetricRegistry, CutsLongValuesAndReplacesWhatIsNoText) {
  MetricRegistry registry;
  auto& family = registry.counters({"a_total", "x", {"one"}});
  family.with({"\xff\x80 ok"}).add();
  std::string euros;
  for (int i = 0; i < 200; ++i) euros += "\xe2\x82\xac";
  family.with({euros}).add();
  const auto families = read_prometheus_text(registry.to_text());
  ASSERT_OK(families);
  EXPECT_EQ(families->at("a_total").samples[0].labels.at("one"), "?? ok");
  EXPECT_EQ(families->at("a_total").samples[1].labels.at("one"), euros.substr(0, 255));
}

TEST(MetricRegistryDeathTest, RefusesNamesThatContradict) {
  MetricRegistry registry;
  registry.counter("a_total", "x");
  registry.histogram("b", "x", {1});
  EXPECT_DEATH(registry.gauge("a_total", "x"), "'a_total' is no gauge");
  EXPECT_DEATH(registry.counter("a_total", "y"), "registered as something else");
  EXPECT_DEATH(registry.counters({"a_total", "x", {"label"}}), "registered as something else");
  EXPECT_DEATH(registry.histogram("b", "x", {2}), "other bounds");
  EXPECT_DEATH(registry.gauge("b_sum", "x"), "a line of the histogram 'b'");
  registry.gauge("c_count", "x");
  EXPECT_DEATH(registry.histogram("c", "x", {1}), "'c_count', a line of this histogram");
}

TEST(MetricRegistryDeathTest, RefusesNamesThatPrometheusDoesNotKnow) {
  MetricRegistry registry;
  for (const char* name : {"", "1a", "a b", "a-b", "ä"})
    EXPECT_DEATH(registry.counter(name, ""), "no name of a metric");
  for (const char* label : {"", "1", "a:b", "__a"})
    EXPECT_DEATH(registry.counters({"a", "", {label}}), "no name of a label");
  EXPECT_DEATH(registry.counters({"a", "", {"x", "x"}}), "twice");
  EXPECT_DEATH(registry.histograms({"a", "", {"le"}}, {1}), "'le'");
  EXPECT_DEATH(registry.counters({"b", "", {"x"}}).with({}), "1 labels, found 0");
}

TEST(MetricRegistry, IsReadWhileOthersCount) {
  MetricRegistry registry;
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < 3; ++thread)
      threads.emplace_back([&, thread] {
        for (int i = 0; i < 300; ++i) {
          registry.counters({"a_total", "x", {"i"}}).with({std::to_string(i % 50)}).add();
          registry.histograms({"b_seconds", "x", {"t"}}, {1, 2})
              .with({std::to_string(thread)})
              .observe(i % 4);
        }
      });
    for (int i = 0; i < 20; ++i) EXPECT_OK(read_prometheus_text(registry.to_text()));
  }
  double count = 0;
  const auto families = read_prometheus_text(registry.to_text());
  ASSERT_OK(families);
  for (const auto& sample : families->at("a_total").samples) count += sample.number;
  EXPECT_EQ(count, 900);
}

TEST(PrometheusText, IsReadStrictly) {
  for (const char* text :
       {"a 1\n", "# HELP a x\na 1\n", "# HELP a x\n# TYPE a counter\na 1",
        "# HELP a x\n# TYPE a counter\na  1\n", "# HELP a x\n# TYPE a counter\na 1 \n",
        "# HELP a x\n# TYPE a counter\na{} 1\n", "# HELP a x\n# TYPE a counter\na{b=\"c} 1\n",
        "# HELP a x\n# TYPE a counter\na{b=\"\\c\"} 1\n", "# HELP a x\n# TYPE a counter\nb 1\n",
        "# HELP a x\n# TYPE a counter\na 1\na 1\n", "# HELP a x\n# TYPE a thing\n",
        "# HELP a x\n# TYPE a histogram\na_bucket{le=\"1\"} 2\na_sum 1\na_count 2\n",
        "# HELP a x\n# TYPE a histogram\na_bucket{le=\"+Inf\"} 2\na_sum 1\na_count 3\n"})
    EXPECT_FALSE(read_prometheus_text(text).ok()) << text;
}

}  // namespace
}  // namespace engram::server
