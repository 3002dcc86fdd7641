// SPDX-License-Identifier: Apache-2.0
// What fades, when, and what a quota makes of it. The images are made up, and so is what codes them
// again; tests/training/fade has real ones.
#include <gtest/gtest.h>

#include "ltm/forgetting/carry_out.h"
#include "ltm/forgetting/forget_config.h"
#include "ltm/store/publish.h"
#include "tests/ltm/forgetting/forget_fixture.h"

namespace engram::ltm {
namespace {

using Seconds = std::chrono::seconds;

constexpr double kMseOf38Db = 10.3;

class PlanFading : public ForgetFixture {
 protected:
  /// Latents of `count` snapshots of an entity from second `first` on, each of some bytes.
  void publish(const std::string& name, int64_t first, int64_t count,
               const LatentQuality& quality = {{kMseOf38Db, 0}}) {
    const auto model = *temporary_file(store_, ".model");
    overwrite_file(model, as_bytes("weights"));
    std::vector<LatentSnapshot> latents;
    for (int64_t i = first; i < first + count; ++i) {
      std::vector<uint8_t> code(2000, static_cast<uint8_t>(i));
      LatentInstance instance{{Buffer::take(std::move(code)), {}}, {}, quality};
      latents.push_back({second(i), 1, {std::move(instance)}});
    }
    ASSERT_OK(publish_model(store_, example_entity(name), 1, model, latents));
  }

  /// Snapshots that are kept as latents alone.
  void keep_latents(const std::string& name, int64_t count,
                    const LatentQuality& quality = {{kMseOf38Db, 0}}) {
    seal_numbers(name, 0, count);
    publish(name, 0, count, quality);
    ASSERT_OK(drop_recorded(store_, example_entity(name), {}));
  }

  static FadeStep step(std::optional<double> psnr_db, Duration after) {
    return {older_than(after), psnr_db};
  }

  static ForgetOptions fading(std::vector<FadeStep> steps) {
    ForgetOptions options;
    options.fade = std::move(steps);
    return options;
  }

  /// The seconds that fade, by what is left in dB (0: a gist).
  std::map<double, std::vector<int64_t>> faded(const ForgetOptions& options,
                                               const std::string& name = "cam") {
    const auto made = plan(options);
    EXPECT_OK(made);
    std::map<double, std::vector<int64_t>> seconds;
    if (!made.ok()) return seconds;
    for (const FadingSnapshots& part : made->entities.at(example_entity(name)).fading)
      for (const Time time : part.times)
        seconds[part.psnr_db.value_or(0)].push_back(to_ns(time) / 1'000'000'000);
    return seconds;
  }

  /// Fades by marking: the latents stay as they are.
  Fade marker() {
    return [this](const std::filesystem::path&, const FadeSet& what, const ProgressSink&,
                  const std::stop_token&) -> Result<FadeReport> {
      ++calls_;
      FadeReport report;
      for (const auto& [entity, parts] : what) {
        for (const FadingSnapshots& part : parts) {
          mark(entity, part);
          report.entities[entity].faded += part.times.size();
        }
      }
      return report;
    };
  }

  void mark(const MemoryId& entity, const FadingSnapshots& part) {
    std::vector<LatentSnapshot> latents;
    for (const Time time : part.times) {
      const std::vector<uint8_t> code(made_bytes_, 1);
      LatentInstance instance{{Buffer::take(std::vector(code)), {}}, {}, {{70.0, 0}}};
      instance.quality.faded_to_db = static_cast<float>(part.psnr_db.value_or(0));
      latents.push_back({time, 1, {std::move(instance)}});
    }
    ASSERT_OK(publish_latents(store_, entity, 1, latents));
  }

  Result<ForgetReport> carry_out_for_quota(const ForgetOptions& options, const ForgetPlan& first) {
    const auto again = [this, quota = quota_after(options, first)](bool may_fade) mutable {
      if (!may_fade) quota.fade.clear();
      return plan(quota);
    };
    return carry_out(store_, first, again, {}, {}, {.fade = marker()});
  }

  int calls_ = 0;
  size_t made_bytes_ = 10;
};

TEST_F(PlanFading, TakesWhatIsOldEnoughAndNotTheNewest) {
  keep_latents("cam", 10);
  now_ = second(10);
  using Faded = std::map<double, std::vector<int64_t>>;
  EXPECT_EQ(faded(fading({step(30, Seconds(7))})), (Faded{{30, {0, 1, 2}}}));
  EXPECT_EQ(faded(fading({step(30, Seconds(3)), step({}, Seconds(8))})),
            (Faded{{0, {0, 1}}, {30, {2, 3, 4, 5, 6}}}));
  EXPECT_EQ(faded(fading({step({}, Seconds(8)), step(30, Seconds(3))})),
            (Faded{{0, {0, 1}}, {30, {2, 3, 4, 5, 6}}}))
      << "in any order the furthest counts";
  EXPECT_EQ(faded(fading({step({}, Seconds(0))})), (Faded{{0, {0, 1, 2, 3, 4, 5, 6, 7, 8}}}))
      << "the newest of each entity is protected";
}

TEST_F(PlanFading, LeavesWhatGainsNothing) {
  now_ = second(100);
  keep_latents("cam", 4);
  EXPECT_TRUE(faded(fading({step(37.5, Seconds(0))})).empty()) << "it has 38 dB";
  EXPECT_EQ(faded(fading({step(36, Seconds(0))})).size(), 1u);
  keep_latents("faded", 4, {{30.0, 0}, {}, 30});
  EXPECT_TRUE(faded(fading({step(30, Seconds(0))}), "faded").empty());
  EXPECT_TRUE(faded(fading({step(31, Seconds(0))}), "faded").empty());
  EXPECT_EQ(faded(fading({step(25, Seconds(0))}), "faded").size(), 1u);
  keep_latents("gist", 4, {{400.0, 0}, {}, LatentQuality::kGist});
  EXPECT_TRUE(faded(fading({step({}, Seconds(0))}), "gist").empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  keep_latents("numbers", 4, {{nan, 0.1}});
  EXPECT_TRUE(faded(fading({step(20, Seconds(0))}), "numbers").empty()) << "it has no images";
  seal_numbers("recorded", 0, 4);
  EXPECT_TRUE(faded(fading({step(20, Seconds(0))}), "recorded").empty())
      << "it waits for consolidation";
}

TEST_F(PlanFading, ReliesOnWhatIsCertain) {
  now_ = second(100);
  keep_latents("cam", 4, {{kMseOf38Db, 0}, {{65.0, 0}}});
  EXPECT_TRUE(faded(fading({step(36, Seconds(0))})).empty()) << "certainly it has but 30 dB";
  EXPECT_EQ(faded(fading({step(28, Seconds(0))})).size(), 1u);
}

TEST_F(PlanFading, TakesWhatIsStillRecordedWhateverItsLatents) {
  now_ = second(100);
  seal_numbers("cam", 0, 4);
  publish("cam", 0, 4, {{90.0, 0}});
  EXPECT_EQ(faded(fading({step(36, Seconds(0))})).at(36), (std::vector<int64_t>{0, 1, 2}));
  seal_numbers("left", 0, 4);
  publish("left", 0, 4, {{30.0, 0}, {}, 30});
  EXPECT_EQ(faded(fading({step(30, Seconds(0))}), "left").size(), 1u)
      << "a killed job left what was recorded";
}

TEST_F(PlanFading, ForgottenSnapshotsDoNotFade) {
  now_ = second(10);
  keep_latents("cam", 10);
  ForgetOptions options = fading({step(30, Seconds(3))});
  options.rules = {older_than(Seconds(7))};
  const auto made = plan(options);
  ASSERT_OK(made);
  EXPECT_EQ(gone(made), (std::vector<int64_t>{0, 1, 2}));
  EXPECT_EQ(made->fading(), 4u);
  EXPECT_GT(made->faded_bytes, 0u);
  const EntityForgetPlan& entity = made->entities.at(example_entity("cam"));
  EXPECT_EQ(entity.stays, 7u);
  EXPECT_EQ(entity.fading_reasons,
            (std::map<std::string, uint64_t>{{"to 30 dB: older than 3s", 4}}));
}

TEST_F(PlanFading, AQuotaFadesBeforeItForgets) {
  now_ = second(100);
  keep_latents("cam", 100);
  ForgetOptions options = fading({step(30, Seconds(1000))});
  EXPECT_EQ(plan(options)->fading(), 0u) << "nothing is old enough";
  options.max_bytes = *directory_bytes(store_) - 50'000;
  const auto made = plan(options);
  ASSERT_OK(made);
  EXPECT_TRUE(made->fades_for_quota);
  EXPECT_GT(made->fading(), 20u);
  EXPECT_LT(made->fading(), 99u);
  EXPECT_EQ(made->snapshots(), 0u);
  EXPECT_EQ(faded(options).at(30).front(), 0) << "the oldest first";
  const auto report = carry_out_for_quota(options, *made);
  ASSERT_OK(report);
  EXPECT_EQ(report->missing_bytes, 0u);
  EXPECT_LE(*directory_bytes(store_), *options.max_bytes);
}

TEST_F(PlanFading, AQuotaForgetsWhereFadingDoesNotSuffice) {
  now_ = second(100);
  keep_latents("cam", 100);
  ForgetOptions options = fading({step(30, Seconds(1000)), step({}, Seconds(1000))});
  options.max_bytes = *directory_bytes(store_) - 150'000;
  made_bytes_ = 2000;  // Nothing becomes smaller.
  const auto made = plan(options);
  ASSERT_OK(made);
  const auto report = carry_out_for_quota(options, *made);
  ASSERT_OK(report);
  EXPECT_GE(calls_, 1);
  EXPECT_GT(report->rewritten.snapshots, 50u);
  EXPECT_LE(*directory_bytes(store_), *options.max_bytes);
}

TEST_F(PlanFading, NeedsWhatCodesImages) {
  now_ = second(100);
  keep_latents("cam", 4);
  const auto made = plan(fading({step(30, Seconds(0))}));
  const auto report = carry_out(store_, *made, {});
  EXPECT_EQ(report.status().code(), StatusCode::kFailedPrecondition);
}

TEST_F(PlanFading, ReadsItsConfiguration) {
  const auto options = parse_forget_config(R"(
forget:
  fade:
    - {match: Vision, after: 7d, psnr: 32}
    - {match: Vision/RGB, after: 30d, unread_for: 10d, psnr: 28.5}
    - {after: 90d, form: gist}
)",
                                           "robot.yaml");
  ASSERT_OK(options);
  ASSERT_EQ(options->fade.size(), 3u);
  EXPECT_EQ(options->fade[0].psnr_db, 32);
  EXPECT_EQ(options->fade[0].rule.age->older_than, Duration(std::chrono::hours(7 * 24)));
  EXPECT_TRUE(options->fade[1].rule.access.has_value());
  EXPECT_EQ(options->fade[1].text(), "to 28.5 dB");
  EXPECT_EQ(options->fade[2].psnr_db, std::nullopt);
  EXPECT_EQ(options->fade[2].text(), "to a gist");
}

TEST_F(PlanFading, IsStrictInItsConfiguration) {
  const auto error_of = [](const std::string& fade) {
    const auto read = parse_forget_config("forget: {fade: [" + fade + "]}", "robot.yaml");
    EXPECT_EQ(read.status().code(), StatusCode::kInvalidArgument) << fade;
    return std::string(read.status().message());
  };
  EXPECT_NE(error_of("{after: 7d}").find("needs 'psnr' or 'form: gist'"), std::string::npos);
  EXPECT_NE(error_of("{psnr: 32}").find("needs 'after'"), std::string::npos);
  EXPECT_NE(error_of("{after: 7d, form: jist}").find("'jist'"), std::string::npos);
  EXPECT_NE(error_of("{after: 7d, form: gist, psnr: 3}").find("no 'psnr'"), std::string::npos);
  EXPECT_NE(error_of("{after: 7d, psnr: 320}").find("320"), std::string::npos);
  EXPECT_NE(error_of("{older_than: 7d, psnr: 32}").find("older_than"), std::string::npos);
}

}  // namespace
}  // namespace engram::ltm
