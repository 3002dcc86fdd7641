// SPDX-License-Identifier: Apache-2.0
// What an audit log costs: noting one call, and verifying a record. The limit is two writes to
// files of as many bytes, without any seal.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "ltm/core/file.h"
#include "server/access/audit_check.h"
#include "server/access/audit_log.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

const AuditEvent kEvent{"kitchen", "viewer", "query", "Vision/RGB/.*/.* @ last:30s", ""};

void AuditAdd(benchmark::State& state) {
  const ScratchDirectory scratch;
  const auto path = scratch.path() / "audit.log";
  if (!AuditLog::create(path).ok()) std::abort();
  const auto log = std::move(*AuditLog::open(path));
  for (auto _ : state)
    if (!log->add(kEvent).ok()) std::abort();
  state.counters["record_bytes"] = benchmark::Counter(
      static_cast<double>(std::filesystem::file_size(path)) / state.iterations());
}
BENCHMARK(AuditAdd);

void AuditAddLimit(benchmark::State& state) {
  const ScratchDirectory scratch;
  File log = std::move(*File::open(scratch.path() / "log", File::Mode::kAppend));
  File where = std::move(*File::open(scratch.path() / "where", File::Mode::kWrite));
  const std::string record(330, 'r'), link(250, 'l');
  for (auto _ : state)
    if (!log.append(as_bytes(record)).ok() || !where.write_at(0, as_bytes(link)).ok()) std::abort();
}
BENCHMARK(AuditAddLimit);

/// Argument: records of the log.
void AuditVerify(benchmark::State& state) {
  const ScratchDirectory scratch;
  const auto path = scratch.path() / "audit.log";
  if (!AuditLog::create(path).ok()) std::abort();
  {
    const auto log = std::move(*AuditLog::open(path));
    for (int64_t i = 0; i < state.range(0); ++i)
      if (!log->add(kEvent).ok()) std::abort();
  }
  for (auto _ : state) {
    const auto report = check_audit_log(path, AuditLog::key_path(path), {}, {});
    if (!report.ok() || !report->is_whole()) std::abort();
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(AuditVerify)->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::server
