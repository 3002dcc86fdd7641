// SPDX-License-Identifier: Apache-2.0
#include "encoders/threads.h"

#include <algorithm>

#include "encoders/torch.h"

// Only OpenBLAS has this function. With another BLAS the address of the weak symbol is null.
extern "C" [[gnu::weak]] void openblas_set_num_threads(int threads);

namespace engram::encoders {

void set_threads(int threads) {
  at::set_num_threads(std::max(threads, 1));
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
}

}  // namespace engram::encoders
