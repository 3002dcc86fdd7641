// SPDX-License-Identifier: Apache-2.0
// hdf5_round_trip FORMAT FROM STORE TO [JPEG_QUALITY]: imports and exports, for
// h5py_round_trip_test.
#include <cstdio>
#include <cstdlib>

#include "tests/datasets/hdf5/round_trip.h"

int main(int argc, char** argv) {
  using namespace engram;
  using namespace engram::datasets;
  if (argc < 5) return 2;
  const auto imported = import_hdf5(argv[1], argv[2], argv[3]);
  if (!imported.ok()) {
    std::fprintf(stderr, "%s\n", imported.status().to_string().c_str());
    return 1;
  }
  for (const auto& [what, count] : imported->reading.not_carried)
    std::printf("not carried: %s: %d\n", what.c_str(), static_cast<int>(count));
  std::printf("damaged: %d\n", static_cast<int>(imported->reading.damaged));
  WritingOptions options;
  if (argc > 5) options.jpeg_quality = std::atoi(argv[5]);
  const auto exported = export_hdf5(argv[1], argv[3], argv[4], options);
  if (!exported.ok()) {
    std::fprintf(stderr, "%s\n", exported.status().to_string().c_str());
    return 1;
  }
  for (const auto& [what, count] : exported->not_held)
    std::printf("not held: %s: %d\n", what.c_str(), static_cast<int>(count));
  return 0;
}
