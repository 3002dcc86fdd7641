// SPDX-License-Identifier: Apache-2.0
#include "reports/crossval_text.h"

#include <fmt/format.h>

#include <cmath>

#include "ltm/memory/result.h"
#include "reports/coverage_text.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

using training::CrossvalFold;
using training::CrossvalReport;
using training::Quality;
using training::VariantQuality;

std::string quality_text(const Quality& quality) {
  if (quality.images > 0)
    return fmt::format("{:.2f} / {:.2f}", quality.mean_psnr_db, quality.pooled_psnr_db);
  return number_text(quality.rmse);
}

std::string signed_text(double db) {
  return std::isnan(db) ? "-" : fmt::format("{:+.2f}", db);
}

std::string bytes_each(double bytes) {
  return fmt::format("{:.0f}", bytes);
}

/// A table with a row per fold and a last row "all".
template <typename Row>
std::string table_of_folds(const CrossvalReport& report, const std::vector<std::string>& header,
                           Row row) {
  TextTable table(header);
  for (const CrossvalFold& fold : report.folds) table.add(row(engram::to_string(fold.first), fold));
  table.add(row("all", report.all));
  return table.to_string("  ");
}

std::string variant_table(const CrossvalReport& report, size_t index) {
  return table_of_folds(report,
                        {"left out", "snapshots", "B trained", "trained", "B left out", "left out",
                         "trained - left", "next", "over copy", "over-next", "over copy"},
                        [index](const std::string& name, const CrossvalFold& fold) {
                          const VariantQuality& variant = fold.variants[index];
                          return std::vector<std::string>{
                              name,
                              count_text(fold.snapshots),
                              bytes_each(variant.latents.trained_bytes),
                              quality_text(variant.latents.trained),
                              bytes_each(variant.latents.left_out_bytes),
                              quality_text(variant.latents.left_out),
                              signed_text(variant.latents.gap_db()),
                              quality_text(variant.prediction[0]),
                              signed_text(fold.gain_db(index, 0)),
                              quality_text(variant.prediction[1]),
                              signed_text(fold.gain_db(index, 1))};
                        });
}

/// The table of reconstructions with residuals below a bound; empty if no bound was asked for.
std::string corrected_table(const CrossvalReport& report, size_t index) {
  if (report.bound_db <= 0) return "";
  const std::string title = fmt::format("with residuals below {:.1f} dB", report.bound_db);
  return table_of_folds(
             report,
             {title, "B trained", "trained", "B left out", "left out", "minimum", "trained - left"},
             [index](const std::string& name, const CrossvalFold& fold) {
               const training::Reconstruction& corrected = fold.variants[index].corrected;
               return std::vector<std::string>{name,
                                               bytes_each(corrected.trained_bytes),
                                               quality_text(corrected.trained),
                                               bytes_each(corrected.left_out_bytes),
                                               quality_text(corrected.left_out),
                                               db_text(corrected.left_out.minimum_psnr_db),
                                               signed_text(corrected.gap_db())};
             }) +
         "\n";
}

/// The table of how often the errors of a variant's predictions were within their bounds.
std::string bound_table(const CrossvalReport& report, size_t index) {
  std::vector<std::string> header{fmt::format("{:.0f} % bound", 100 * ltm::kBoundProbability)};
  for (const char* ahead : {"next", "over-next"})
    for (const char* what : {"within", "mean bound", "width", "expected", "real"})
      header.push_back(fmt::format("{}: {}", ahead, what));
  return table_of_folds(report, header, [index](const std::string& name, const CrossvalFold& fold) {
    const VariantQuality& variant = fold.variants[index];
    std::vector<std::string> row{name};
    for (size_t ahead = 0; ahead < training::kMinHorizon; ++ahead) {
      const Quality& quality = variant.prediction[ahead];
      const bool has_images = quality.images > 0;
      const training::Coverage& told =
          has_images ? variant.bound_coverage[ahead].images : variant.bound_coverage[ahead].numbers;
      const auto text = has_images ? db_text : number_text;
      row.push_back(within_text(told));
      row.push_back(text(told.mean_bound));
      row.push_back(has_images ? image_width_text(told) : number_width_text(told));
      row.push_back(text(told.expected));
      row.push_back(text(has_images ? quality.pooled_psnr_db : quality.rmse));
    }
    return row;
  });
}

/// The table of predictions that were given the joints that followed, as a plan; empty if there is
/// no condition.
std::string plan_table(const CrossvalReport& report, size_t index) {
  const auto& all = report.all.variants[index].planned;
  if (all[0].images == 0 && all[0].numbers == 0) return "";
  return table_of_folds(report, {"told what came as a plan", "next", "over-next"},
                        [index](const std::string& name, const CrossvalFold& fold) {
                          const auto& planned = fold.variants[index].planned;
                          return std::vector<std::string>{name, quality_text(planned[0]),
                                                          quality_text(planned[1])};
                        }) +
         "\n";
}

std::string similarity_text(const training::SimilarityQuality& similarity) {
  if (similarity.snapshots == 0) return "";
  return fmt::format(
      "  nearest by global code, {} of the left-out asked for: by pixels on average number {:.1f} "
      "of "
      "{}; next in time {:.0f} % (by pixels {:.0f} %)\n",
      count_text(similarity.snapshots), similarity.mean_rank, count_text(similarity.others),
      100 * similarity.neighbour_share, 100 * similarity.pixel_neighbour_share);
}

std::string baseline_table(const CrossvalReport& report) {
  std::vector<std::string> header{"left out"};
  for (const char* ahead : {"next", "over-next"})
    for (size_t way = 0; way < training::kBaselines; ++way)
      header.push_back(
          fmt::format("{}: {}", ahead, to_string(static_cast<training::Baseline>(way))));
  return table_of_folds(report, header, [](const std::string& name, const CrossvalFold& fold) {
    std::vector<std::string> row{name};
    for (size_t ahead = 0; ahead < training::kMinHorizon; ++ahead)
      for (const auto& way : fold.baselines) row.push_back(quality_text(way[ahead]));
    return row;
  });
}

std::string comparison_table(const CrossvalFold& all) {
  TextTable table(
      {"over all folds", "B left out", "model", "trained", "left out", "next", "over-next"});
  for (const VariantQuality& variant : all.variants)
    table.add({std::string(to_string(variant.variant)), bytes_each(variant.latents.left_out_bytes),
               bytes_text(static_cast<double>(variant.model_bytes)),
               quality_text(variant.latents.trained), quality_text(variant.latents.left_out),
               quality_text(variant.prediction[0]), quality_text(variant.prediction[1])});
  for (size_t way = 0; way < training::kBaselines; ++way)
    table.add({std::string(to_string(static_cast<training::Baseline>(way))), "", "", "", "",
               quality_text(all.baselines[way][0]), quality_text(all.baselines[way][1])});
  return table.to_string("  ");
}

/// The table of how errors grow with the horizon; empty if only the next and over-next snapshots
/// were measured.
std::string ahead_table(const CrossvalFold& all) {
  const size_t ahead = all.baselines.front().size();
  // The tables of the variants already have the next and over-next snapshots.
  if (ahead <= training::kMinHorizon) return "";
  std::vector<std::string> header{"snapshots ahead"};
  for (size_t step = 1; step <= ahead; ++step) header.push_back(std::to_string(step));
  TextTable table(header);
  const auto add = [&](std::string_view name, const std::vector<Quality>& qualities) {
    std::vector<std::string> row{std::string(name)};
    for (const Quality& quality : qualities) row.push_back(quality_text(quality));
    table.add(std::move(row));
  };
  for (const VariantQuality& variant : all.variants)
    add(to_string(variant.variant), variant.prediction);
  for (size_t way = 0; way < training::kBaselines; ++way)
    add(to_string(static_cast<training::Baseline>(way)), all.baselines[way]);
  return "\n" + table.to_string("  ");
}

}  // namespace

std::string crossval_text(const CrossvalReport& report) {
  std::string text = report.entity.printable() + "\n";
  for (size_t i = 0; i < report.all.variants.size(); ++i) {
    const VariantQuality& variant = report.all.variants[i];
    text += fmt::format("{}, a model takes {} beside the bytes\n", to_string(variant.variant),
                        bytes_text(static_cast<double>(variant.model_bytes)));
    text += variant_table(report, i) + "\n" + corrected_table(report, i) + bound_table(report, i) +
            "\n" + plan_table(report, i) + similarity_text(variant.similarity);
  }
  text += "predictions that learn nothing\n" + baseline_table(report) + "\n";
  return text + "beside each other\n" + comparison_table(report.all) + ahead_table(report.all);
}

std::string fold_text(const CrossvalFold& fold, size_t number) {
  std::string text;
  for (size_t i = 0; i < fold.variants.size(); ++i) {
    const VariantQuality& variant = fold.variants[i];
    text += fmt::format("fold {}, {}, left out {}: {}", number, to_string(variant.variant),
                        engram::to_string(fold.first), quality_text(variant.latents.left_out));
    if (variant.latents.left_out.images > 0)
      text += fmt::format(" dB at {} B (trained on: {} dB at {} B), {} and {} dB over copying",
                          bytes_each(variant.latents.left_out_bytes),
                          quality_text(variant.latents.trained),
                          bytes_each(variant.latents.trained_bytes),
                          signed_text(fold.gain_db(i, 0)), signed_text(fold.gain_db(i, 1)));
    if (const training::Reconstruction& corrected = variant.corrected; corrected.left_out_bytes > 0)
      text += fmt::format("; with residuals {} dB at {} B (trained on: {} dB at {} B)",
                          quality_text(corrected.left_out), bytes_each(corrected.left_out_bytes),
                          quality_text(corrected.trained), bytes_each(corrected.trained_bytes));
    if (i + 1 < fold.variants.size()) text += '\n';
  }
  return text;
}

}  // namespace engram::reports
