// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"
#include "ltm/redaction/redaction_options.h"

namespace engram::ltm::testing {

/// The side of the secret that a marker is in the upper left corner of. Unit: pixels.
inline constexpr int kSecretSide = 16;

/// Writes a detector that finds secrets by their marker, a magenta pixel or its bytes in grey, and
/// returns its command.
/// Another `mode` misbehaves at images with a marker: "silent", "dies", "garbage", "endless",
/// "outside", "chatty"; or at the start: "mute", "ends", "rude".
inline std::vector<std::string> marker_program(const std::filesystem::path& folder,
                                               const std::string& mode = "finds") {
  const std::filesystem::path file = folder / "find_marker.py";
  std::ofstream(file) << R"(import json, os, sys, time
mode = sys.argv[1]
if mode == 'mute':
    time.sleep(1000)
if mode == 'ends':
    sys.exit(3)
if mode == 'rude':
    print('hello')
print('{"ready": true}', flush=True)
source = sys.stdin.buffer
while True:
    line = source.readline()
    if not line:
        break
    header = json.loads(line)
    pixels = source.read(header['bytes'])
    boxes = []
    at, channels = pixels.find(b'\xff\x00\xff'), header['channels']
    if at >= 0 and at % channels == 0:
        x, y = at // channels % header['width'], at // channels // header['width']
        boxes = [[x, y, 16, 16]]
        if mode == 'silent':
            time.sleep(1000)
        if mode == 'dies':
            os._exit(1)
        if mode == 'garbage':
            print('{"image": 2, "boxes": [[0, 0, "wide", NaN]]}', flush=True)
            continue
        if mode == 'endless':
            while True:
                sys.stdout.write('x' * 65536)
        if mode == 'outside':
            boxes = [[-1e300, -5, 2e300, 10], [1e308, 1e308, 1e308, 1e308]]
        if mode == 'chatty':
            print(json.dumps({'image': header['image'], 'boxes': []}))
    print(json.dumps({'image': header['image'], 'boxes': boxes}), flush=True)
)";
  return {"/usr/bin/python3", file.string(), mode};
}

/// Options of a detector that finds markers.
inline RedactionOptions marker_redaction(const std::filesystem::path& folder,
                                         const std::string& mode = "finds") {
  RedactionOptions options;
  ProgramDetector::Options program;
  program.command = marker_program(folder, mode);
  program.timeout = std::chrono::seconds(mode == "finds" ? 20 : 1);
  options.detector = program;
  options.grow = 0;
  options.hold = Duration(0);
  return options;
}

/// The bytes of the secret's row `y`, which no other image has: random colours.
inline std::vector<uint8_t> secret_row(int y) {
  std::mt19937 random(static_cast<unsigned>(1234 + y));
  std::vector<uint8_t> row;
  for (int i = 0; i < 3 * kSecretSide; ++i)
    row.push_back(static_cast<uint8_t>(random() % 200 + 20));
  if (y == 0) {
    row[0] = 255;
    row[1] = 0;
    row[2] = 255;
  }
  return row;
}

/// An RGB image of grey, with a secret at (x, y) unless x is negative.
inline idf::NdArray image_with_secret(int width, int height, int x, int y) {
  std::vector<uint8_t> pixels(static_cast<size_t>(width) * height * 3, 90);
  for (int row = 0; x >= 0 && row < kSecretSide; ++row) {
    const std::vector<uint8_t> secret = secret_row(row);
    std::copy(secret.begin(), secret.end(),
              pixels.begin() + (static_cast<ptrdiff_t>(y + row) * width + x) * 3);
  }
  return idf::NdArray::take({height, width, 3}, std::move(pixels));
}

/// The same as one grey image, and as a list of `count` of which the last one shows it.
template <typename T = uint8_t>
idf::NdArray grey_images_with_secret(int count, int width, int height, int x, int y) {
  std::vector<T> pixels(static_cast<size_t>(count) * width * height, T{90});
  for (int row = 0; x >= 0 && row < kSecretSide; ++row) {
    const std::vector<uint8_t> secret = secret_row(row);
    std::copy(secret.begin(), secret.begin() + kSecretSide,
              pixels.begin() + (static_cast<ptrdiff_t>(count - 1) * height + y + row) * width + x);
  }
  return idf::NdArray::take({count, height, width}, std::move(pixels));
}

/// Whether bytes hold a row of the secret. The first row is the marker's.
inline bool has_secret(std::string_view bytes) {
  for (int y = 0; y < kSecretSide; ++y) {
    const std::vector<uint8_t> row = secret_row(y);
    // A third of a row is enough to recognise it.
    const std::string_view part(reinterpret_cast<const char*>(row.data()), row.size() / 3);
    if (bytes.find(part) != std::string_view::npos) return true;
  }
  return false;
}

inline bool has_secret(const idf::NdArray& array) {
  return has_secret(as_text(array.bytes()));
}

/// Whether any file below a folder holds it.
inline bool has_secret_file(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    if (has_secret(bytes)) return true;
  }
  return false;
}

}  // namespace engram::ltm::testing
