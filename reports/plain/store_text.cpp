// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/store_text.h"

#include <algorithm>
#include <cmath>

#include "reports/plain/text.h"
#include "training/quality/psnr.h"

namespace engram::reports {

namespace {

/// The mean per snapshot, or zero if there are none.
double each(uint64_t total, uint64_t count) {
  return count == 0 ? 0 : static_cast<double>(total) / static_cast<double>(count);
}

double mean_of(double sum, uint64_t count) {
  return count == 0 ? std::nan("") : sum / static_cast<double>(count);
}

std::string quality_text(const ltm::LatentSums& sums) {
  std::string text;
  if (sums.image_rows > 0)
    text += fmt::format(", PSNR {} mean over images, {} pooled",
                        db_text(mean_of(sums.psnr_db, sums.image_rows)),
                        db_text(training::psnr_db(mean_of(sums.image_mse, sums.image_rows))));
  if (sums.number_rows > 0)
    text += fmt::format(", RMSE {} over numbers",
                        number_text(std::sqrt(mean_of(sums.number_mse, sums.number_rows))));
  return text;
}

std::string bytes_each(uint64_t total, uint64_t count) {
  return fmt::format("{} ({} each)", bytes_text(static_cast<double>(total)),
                     bytes_text(each(total, count)));
}

/// Such as ", as h264, numbers as columns"; empty if the store uses neither.
std::string stored_forms_text(const ltm::StoredForms& forms) {
  std::string text;
  for (const std::string& codec : forms.media_codecs)
    text += (text.empty() ? ", as " : " and ") + codec;
  if (forms.has_columns()) text += ", numbers as columns";
  return text;
}

}  // namespace

Json stored_entity_json(const ltm::EntitySummary& summary, const ltm::StoredForms& forms,
                        double rate_hz) {
  Json models = Json::array();
  for (const ltm::ModelInfo& model : summary.models)
    models.push_back({{"version", model.version}, {"file", model.file}, {"bytes", model.bytes}});
  Json json{{"id", summary.id.to_string()},
            {"snapshots", summary.snapshots},
            {"recorded_snapshots", summary.recorded_snapshots},
            {"latent_snapshots", summary.latent_snapshots},
            {"augmented_snapshots", summary.augmented_snapshots},
            {"offered_snapshots", summary.offered},
            {"first_ns", to_ns(summary.first)},
            {"last_ns", to_ns(summary.last)},
            {"rate_hz", rate_hz},
            {"dropped_by", summary.dropped_by},
            {"forgotten_snapshots", summary.forgotten.snapshots},
            {"offered_bytes", summary.offered_bytes},
            {"raw_bytes", summary.raw_bytes},
            {"stored_bytes", summary.stored_bytes},
            {"media_codecs", forms.media_codecs},
            {"has_number_columns", forms.has_columns()},
            {"latent_bytes", summary.latent_bytes},
            {"model_bytes", summary.model_bytes},
            {"models", std::move(models)}};
  const ltm::LatentSums& sums = summary.latent;
  if (sums.image_rows > 0) {
    json["psnr_mean_over_images_db"] = mean_of(sums.psnr_db, sums.image_rows);
    json["psnr_pooled_error_db"] = training::psnr_db(mean_of(sums.image_mse, sums.image_rows));
  }
  if (sums.number_rows > 0) json["rmse"] = std::sqrt(mean_of(sums.number_mse, sums.number_rows));
  return json;
}

void print_stored_entity(const ltm::EntitySummary& summary, const ltm::StoredForms& forms,
                         double rate_hz) {
  print("\n" + summary.id.printable());
  print(fmt::format("  snapshots  {} of {} offered: {} recorded, {} as latents",
                    count_text(summary.snapshots), count_text(summary.offered),
                    count_text(summary.recorded_snapshots), count_text(summary.latent_snapshots)));
  if (summary.augmented_snapshots > 0)
    print(fmt::format("  augmented  {}: made of others, never perceived",
                      count_text(summary.augmented_snapshots)));
  std::string reasons;
  for (const auto& [filter, count] : summary.dropped_by)
    reasons += fmt::format("{}{} by {}", reasons.empty() ? "" : ", ", count_text(count), filter);
  if (!reasons.empty()) print("  dropped    " + reasons);
  if (summary.forgotten.snapshots > 0)
    print(fmt::format("  forgotten  {}", count_text(summary.forgotten.snapshots)));
  if (summary.snapshots > 0)
    print(fmt::format("  span       {} to {}, {:.3g} Hz", to_string(summary.first),
                      to_string(summary.last), rate_hz));
  print(fmt::format("  raw        {} offered, {} kept",
                    bytes_text(static_cast<double>(summary.offered_bytes)),
                    bytes_each(summary.raw_bytes, summary.snapshots)));
  print("  stored     " + bytes_each(summary.stored_bytes, summary.recorded_snapshots) +
        stored_forms_text(forms));
  if (summary.latent_snapshots == 0) return;
  print(fmt::format(
      // Latents cannot be decoded without their model, so its bytes count too.
      "  latent     {} + {} model = {}", bytes_each(summary.latent_bytes, summary.latent_snapshots),
      bytes_text(static_cast<double>(summary.model_bytes)),
      bytes_each(summary.latent_bytes + summary.model_bytes, summary.latent_snapshots)));
  std::string models;
  for (const ltm::ModelInfo& model : summary.models)
    models += fmt::format("{}v{}", models.empty() ? "" : ", ", model.version);
  print("  models     " + models + quality_text(summary.latent));
}

void StoredSegment::add(const ltm::EntitySummary& summary) {
  ++entities;
  if (summary.snapshots > 0) {
    first = snapshots == 0 ? summary.first : std::min(first, summary.first);
    last = snapshots == 0 ? summary.last : std::max(last, summary.last);
  }
  snapshots += summary.snapshots;
  raw_bytes += summary.raw_bytes;
  stored_bytes += summary.stored_bytes + summary.latent_bytes;
}

void print_stored_segment(const ltm::MemoryId& segment, const StoredSegment& sums) {
  print("\n" + segment.printable());
  print(fmt::format("  entities   {}", count_text(sums.entities)));
  print(fmt::format("  snapshots  {}", count_text(sums.snapshots)));
  if (sums.snapshots > 0)
    print(fmt::format("  span       {} to {}", to_string(sums.first), to_string(sums.last)));
  print("  raw        " + bytes_each(sums.raw_bytes, sums.snapshots));
  print("  stored     " + bytes_each(sums.stored_bytes, sums.snapshots));
}

Json types_json(const ltm::SegmentTypes& types) {
  Json json = Json::object();
  for (const auto& [segment, type] : types.all()) json[segment.to_string()] = to_string(type);
  return json;
}

void print_types(const ltm::SegmentTypes& types) {
  if (!types.all().empty()) print("\nTypes of segments");
  for (const auto& [segment, type] : types.all())
    print(fmt::format("  {}  {}", segment.printable(), to_string(type)));
}

}  // namespace engram::reports
