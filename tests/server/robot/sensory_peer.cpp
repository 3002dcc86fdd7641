// SPDX-License-Identifier: Apache-2.0
// Commits images to a server one after the other, until it is killed: sensory_peer ENDPOINT ENTITY.
// Once they need not be sent any more, it says so.
#include <cstdio>
#include <iostream>

#include "server/client/memory_client.h"
#include "tests/server/robot/sensory_images.h"

int main(int argc, char** argv) {
  using namespace engram;
  if (argc != 3) return 2;
  const auto client = server::MemoryClient::connect(argv[1]);
  if (!client.ok()) return 1;
  const int64_t begin = to_ns(system_now());
  for (int64_t i = 0;; ++i) {
    const ltm::Commit commit =
        testing::image_commit(argv[2], begin + i, 50'000 + static_cast<size_t>(i % 7) * 1000);
    if (const Status status = (*client)->commit(commit); !status.ok()) {
      std::cerr << status.to_string() << "\n";
      return 1;
    }
    if (i == 10) std::cout << "writing" << std::endl;
  }
}
