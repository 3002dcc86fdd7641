// SPDX-License-Identifier: Apache-2.0
#include "reports/eval_text.h"

#include <algorithm>
#include <cmath>

#include "ltm/memory/result.h"
#include "reports/coverage_text.h"
#include "reports/plain/output.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

std::vector<std::string> image_row(const std::string& what, const training::Quality& quality) {
  return {what,
          count_text(quality.images),
          db_text(quality.mean_psnr_db),
          db_text(quality.pooled_psnr_db),
          db_text(quality.low_psnr_db),
          db_text(quality.minimum_psnr_db)};
}

std::vector<std::string> number_row(const std::string& what, const training::Quality& quality) {
  return {what, count_text(quality.numbers), number_text(quality.rmse)};
}

/// Calls `add` with a label and each quality of an entity, in the order of the report.
template <typename F>
void for_each_quality(const training::EntityEvaluation& entity, F add) {
  add("reconstruction", entity.reconstruction);
  add("reconstruction, left-out recordings", entity.left_out_reconstruction);
  for (size_t known = 0; known < entity.prediction.size(); ++known) {
    const std::string name(training::to_string(static_cast<training::Known>(known)));
    for (const training::PredictionQuality& prediction : entity.prediction[known]) {
      const std::string ahead = fmt::format("{} ahead, {}", prediction.horizon, name);
      add("predicted " + ahead, prediction.model);
      add("copy-last " + ahead, prediction.copy_last);
    }
  }
}

/// Calls `add` with a label, the coverage of bounds and the quality that belongs to it.
template <typename F>
void for_each_bound_coverage(const training::EntityEvaluation& entity, F add) {
  for (size_t known = 0; known < entity.prediction.size(); ++known) {
    const std::string name(training::to_string(static_cast<training::Known>(known)));
    for (const training::PredictionQuality& prediction : entity.prediction[known]) {
      const std::string ahead = fmt::format("{} ahead, {}", prediction.horizon, name);
      add("predicted " + ahead, prediction.model_bound_coverage, prediction.model);
      add("copy-last " + ahead, prediction.copy_bound_coverage, prediction.copy_last);
    }
  }
}

void print_bounds(const training::EntityEvaluation& entity) {
  TextTable table({fmt::format("{:.0f} % bound", 100 * ltm::kBoundProbability), "predictions",
                   "within", "mean bound", "width", "expected", "real, pooled"});
  bool has_any = false;
  const auto add = [&](const std::string& what, const training::Coverage& coverage, double real,
                       std::string (*text)(double),
                       std::string (*width)(const training::Coverage&)) {
    // A row without predictions is left out: a coverage of 0 % would look like a bad bound.
    if (coverage.predictions == 0) return;
    has_any = true;
    table.add({what, count_text(coverage.predictions), within_text(coverage),
               text(coverage.mean_bound), width(coverage), text(coverage.expected), text(real)});
  };
  for_each_bound_coverage(entity, [&](const std::string& what,
                                      const training::BoundCoverage& bound_coverage,
                                      const training::Quality& quality) {
    add(what, bound_coverage.images, quality.pooled_psnr_db, db_text, image_width_text);
    add(what + ", numbers", bound_coverage.numbers, quality.rmse, number_text, number_width_text);
  });
  if (has_any) print(table.to_string("  "));
}

/// The bytes that latents take per snapshot, beside their ideal code length.
std::string code_text(const training::CodeLength& code) {
  const auto rows = static_cast<double>(code.rows);
  std::string text = fmt::format("  code of latents: {:.1f} bytes a snapshot, ideal {:.1f}",
                                 code.coded_bytes / rows, code.ideal_bytes / rows);
  if (code.later_rows == 0) return text;
  const auto later = static_cast<double>(code.later_rows);
  text += fmt::format("; with one before it {:.1f}", code.later_bytes / later);
  if (!(code.prior_row_bytes > 0)) return text;
  return text + fmt::format(", as the prior told in training {:.1f}", code.prior_row_bytes);
}

}  // namespace

void print_evaluation(const training::EntityEvaluation& entity) {
  print(fmt::format("\n{} v{}: {} snapshots as latents{}", entity.entity.printable(),
                    entity.model_version, count_text(entity.snapshots),
                    entity.not_evaluated == 0
                        ? ""
                        : fmt::format(", {} of them not evaluated: their recorded form is gone",
                                      count_text(entity.not_evaluated))));
  TextTable bytes({"bytes", "raw", "online", "latents", "model", "latents + model"});
  const auto count = static_cast<double>(std::max<uint64_t>(entity.snapshots, 1));
  const auto add_bytes = [&bytes](const std::string& what, const training::EntityEvaluation& of,
                                  double divisor) {
    std::vector<std::string> row{what};
    for (const uint64_t value : {of.raw_bytes, of.stored_bytes, of.latent_bytes, of.model_bytes,
                                 of.latent_bytes + of.model_bytes})
      row.push_back(bytes_text(static_cast<double>(value) / divisor));
    bytes.add(std::move(row));
  };
  add_bytes("in all", entity, 1);
  add_bytes("per snapshot", entity, count);
  print(bytes.to_string("  "));
  if (!std::isnan(entity.access.in_order_ms))
    print(fmt::format(
        "  decoded in {:.1f} ms each in order (mean), {:.1f} ms scattered (median; 99 % "
        "within {:.1f} ms)",
        entity.access.in_order_ms, entity.access.scattered_ms, entity.access.scattered_p99_ms));
  if (entity.code.rows > 0) print(code_text(entity.code));
  TextTable images(
      {"PSNR", "images", "mean over images", "pooled error", "5 % quantile", "minimum"});
  TextTable numbers({"RMSE", "values", "over numbers"});
  bool has_images = false, has_numbers = false;
  for_each_quality(entity, [&](const std::string& what, const training::Quality& quality) {
    if (quality.images > 0) images.add(image_row(what, quality));
    if (quality.numbers > 0) numbers.add(number_row(what, quality));
    has_images |= quality.images > 0;
    has_numbers |= quality.numbers > 0;
  });
  if (has_images) print(images.to_string("  "));
  if (has_numbers) print(numbers.to_string("  "));
  print_bounds(entity);
}

}  // namespace engram::reports
