// SPDX-License-Identifier: Apache-2.0
#include "reports/forms_text.h"

#include <array>

#include "reports/plain/text.h"

namespace engram::reports {

namespace {

std::string each(int64_t bytes, int64_t rows) {
  return bytes_text(static_cast<double>(bytes) / static_cast<double>(rows));
}

std::string count(int64_t rows) {
  return count_text(static_cast<uint64_t>(rows));
}

/// A form, with the number of rows and bytes that were kept in it.
struct Kept {
  std::string_view name;
  int64_t rows = 0;
  int64_t bytes = 0;
};

std::array<Kept, 5> kept_forms(const encoders::StoredForms& forms) {
  return {{{"latents", forms.latent_rows, forms.latent_kept_bytes},
           {"refined", forms.refined_rows, forms.refined_kept_bytes},
           {"with residual", forms.residual_rows, forms.residual_kept_bytes},
           {"video", forms.video_rows, forms.video_kept_bytes},
           {"without loss", forms.lossless_rows, forms.lossless_kept_bytes}}};
}

std::string joined(const std::vector<std::string>& parts) {
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

std::string bound_text(double bound_db, int64_t noise_images) {
  std::string text = fmt::format("{:.1f} dB", bound_db);
  if (noise_images > 0) text += fmt::format(", from the noise of {} images", count(noise_images));
  return text;
}

std::string kept_text(const encoders::StoredForms& forms) {
  std::vector<std::string> parts;
  for (const Kept& kept : kept_forms(forms))
    if (kept.rows > 0)
      parts.push_back(
          fmt::format("{} {}, {} each", count(kept.rows), kept.name, each(kept.bytes, kept.rows)));
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::vector<std::string> forms_text(const encoders::StoredForms& forms) {
  std::vector<std::string> lines{
      fmt::format("{} each: {}", each(forms.kept_bytes, forms.rows), kept_text(forms))};
  if (forms.bound_db > 0)
    lines.push_back("bound " + bound_text(forms.bound_db, forms.noise_images));
  // A form that was not tried has no bytes and is left out, not shown as free.
  std::vector<std::string> alone;
  if (forms.latent_bytes > 0 && forms.bound_db > 0)
    alone.push_back(fmt::format("latents {}, {} of {} below the bound",
                                each(forms.latent_bytes, forms.rows), count(forms.below_bound_rows),
                                count(forms.rows)));
  if (forms.residual_bytes > 0)
    alone.push_back("latents with residuals " + each(forms.residual_bytes, forms.rows));
  if (forms.video_bytes > 0) alone.push_back("video " + each(forms.video_bytes, forms.rows));
  if (forms.lossless_bytes > 0)
    alone.push_back("without loss " + each(forms.lossless_bytes, forms.rows));
  if (!alone.empty()) lines.push_back("each form alone: " + joined(alone));
  if (forms.refine_tried_rows > 0)
    lines.push_back(fmt::format("refining was tried for {}", count(forms.refine_tried_rows)));
  return lines;
}

Json forms_json(const encoders::StoredForms& forms) {
  if (forms.rows == 0) return nullptr;
  return {{"representation", forms.representation},
          {"bound_db", forms.bound_db},
          {"noise_images", forms.noise_images},
          {"noise_grey_levels", forms.noise},
          {"rows", forms.rows},
          {"latent_rows", forms.latent_rows},
          {"refined_rows", forms.refined_rows},
          {"residual_rows", forms.residual_rows},
          {"video_rows", forms.video_rows},
          {"lossless_rows", forms.lossless_rows},
          {"kept_bytes", forms.kept_bytes},
          {"latent_kept_bytes", forms.latent_kept_bytes},
          {"refined_kept_bytes", forms.refined_kept_bytes},
          {"residual_kept_bytes", forms.residual_kept_bytes},
          {"video_kept_bytes", forms.video_kept_bytes},
          {"lossless_kept_bytes", forms.lossless_kept_bytes},
          {"below_bound_rows", forms.below_bound_rows},
          {"refine_tried_rows", forms.refine_tried_rows},
          {"latent_bytes", forms.latent_bytes},
          {"residual_bytes", forms.residual_bytes},
          {"video_bytes", forms.video_bytes},
          {"lossless_bytes", forms.lossless_bytes}};
}

}  // namespace engram::reports
