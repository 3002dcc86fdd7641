// SPDX-License-Identifier: Apache-2.0
#include "cli/forms_text.h"

#include "cli/text.h"

namespace engram::cli {

namespace {

std::string each(int64_t bytes, int64_t rows) {
  return bytes_text(static_cast<double>(bytes) / static_cast<double>(rows));
}

std::string count(int64_t rows) {
  return count_text(static_cast<uint64_t>(rows));
}

}  // namespace

std::string forms_text(const encoders::StoredForms& forms) {
  std::string text = fmt::format("{} as latents", count(forms.latent_rows));
  if (forms.representation != "latents")
    text = fmt::format("{}, {} as video, {} without loss; each at least {:.1f} dB", text,
                       count(forms.video_rows), count(forms.lossless_rows), forms.bound_db);
  text += fmt::format("; {} each", each(forms.kept_bytes, forms.rows));
  if (forms.latent_bytes > 0 && forms.representation != "latents")
    text += fmt::format(" (latents alone {}, {} of them below the bound)",
                        each(forms.latent_bytes, forms.rows), count(forms.below_bound_rows));
  if (forms.video_bytes > 0)
    text += fmt::format(" (video alone {})", each(forms.video_bytes, forms.rows));
  return text;
}

Json forms_json(const encoders::StoredForms& forms) {
  if (forms.rows == 0) return nullptr;
  return {{"representation", forms.representation},
          {"bound_db", forms.bound_db},
          {"rows", forms.rows},
          {"latent_rows", forms.latent_rows},
          {"video_rows", forms.video_rows},
          {"lossless_rows", forms.lossless_rows},
          {"below_bound_rows", forms.below_bound_rows},
          {"kept_bytes", forms.kept_bytes},
          {"latent_bytes", forms.latent_bytes},
          {"video_bytes", forms.video_bytes}};
}

}  // namespace engram::cli
