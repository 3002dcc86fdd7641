// SPDX-License-Identifier: Apache-2.0
#include "tests/server/soak/soak_ledger.h"

#include <fcntl.h>
#include <unistd.h>

#include <fstream>

#include "ltm/core/check.h"

namespace engram::soak {

Ledger::Ledger(const std::filesystem::path& file)
    : file_(::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600)) {
  ENGRAM_CHECK(file_ >= 0, "cannot write '{}'", file.string());
}

Ledger::~Ledger() {
  ::close(file_);
}

void Ledger::write(int64_t number) const {
  // Of fixed size: one call writes it whole, or not at all.
  ENGRAM_CHECK(::write(file_, &number, sizeof(number)) == sizeof(number), "the ledger is full");
}

std::vector<int64_t> Ledger::read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<int64_t> numbers;
  for (int64_t number = 0; in.read(reinterpret_cast<char*>(&number), sizeof(number));)
    numbers.push_back(number);
  return numbers;
}

}  // namespace engram::soak
