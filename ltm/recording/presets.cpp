// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/presets.h"

#include <array>
#include <string>

namespace engram::ltm {

namespace {

constexpr std::array<RecordingPreset, 3> kPresets{{
    {"recorder", R"(# Everything, exactly as it came.
entities:
  - match: .*
    name: everything
    filters: []
    codecs:
      - {kind: image, codec: rowpred}
)"},
    {"balanced", R"(# Five snapshots a second, fewer while nothing changes, each exactly as it came.
entities:
  # What was done and said is never left out: each snapshot of it is news, and others link to it.
  - match: Skills?|Speech|Tasks|Navigation
    name: deeds
    filters: []
    codecs:
      - {kind: image, codec: png}
  - match: .*
    name: everything
    keep_linked: 10s
    filters:
      - frequency: {rate: 5Hz}
      - similarity:
          images: {measure: ssim, bound: 0.98}
          numbers: {measure: max_abs, bound: 0.001}
          orientations: {measure: angle, bound: 0.001}
          max_gap: 2s
    codecs:
      - {kind: image, codec: png}
)"},
    {"small",
     R"(# Five snapshots a second, fewer while little changes, images with loss: on five recordings of a
# robot's camera (640 x 480, 5 Hz) H.264 keeps 39.7 dB in 6.6 kB each, JPEG, where its encoder is
# not installed, 44.1 dB in 42.4 kB.
entities:
  # What was done and said is never left out: each snapshot of it is news, and others link to it.
  - match: Skills?|Speech|Tasks|Navigation
    name: deeds
    filters: []
    codecs:
      - {kind: image, codec: png}
  - match: .*
    name: everything
    keep_linked: 10s
    filters:
      - frequency: {rate: 5Hz}
      - similarity:
          images: {measure: ssim, bound: 0.95}
          numbers: {measure: max_abs, bound: 0.01}
          orientations: {measure: angle, bound: 0.01}
          max_gap: 10s
    codecs:
      - {kind: image, codec: ["h264:crf=18,group=10", jpeg]}
)"},
}};

}  // namespace

std::span<const RecordingPreset> all_recording_presets() {
  return kPresets;
}

Result<std::string_view> recording_preset(std::string_view name) {
  std::string known;
  for (const RecordingPreset& preset : kPresets) {
    if (preset.name == name) return preset.yaml;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", preset.name);
  }
  return not_found("preset '{}': needs one of {}", name, known);
}

}  // namespace engram::ltm
