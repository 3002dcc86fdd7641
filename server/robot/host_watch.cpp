// SPDX-License-Identifier: Apache-2.0
#include "server/robot/host_watch.h"

#include <algorithm>

#include "ltm/core/log.h"

namespace engram::server {

namespace {

const std::string& name_of(const HostWatch::Watched& watched) {
  return watched.server->service().options().name;
}

}  // namespace

HostWatch::HostWatch(const Options& options, ltm::MemoryId entity)
    : reader_(options.reader), entity_(std::move(entity)) {}

Result<HostWatch> HostWatch::create(const Options& options, const std::vector<Watched>& watched) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId entity, host_state_entity(options.host));
  HostWatch watch(options, std::move(entity));
  for (const Watched& each : watched) {
    ENGRAM_ASSIGN_OR_RETURN(auto governor,
                            LimitGovernor::create({.configured_bytes = each.limits.bytes.value(),
                                                   .floor_bytes = each.min_bytes}));
    watch.governed_.push_back({each, std::move(governor)});
    if (!each.has_system_state) continue;
    const ltm::MemoryId segment = watch.entity_.parent().parent();
    ENGRAM_RETURN_IF_ERROR(each.server->service().declare(segment, host_state_type()));
  }
  return watch;
}

void HostWatch::look(SteadyTime now) {
  const auto host = reader_.read();
  Status status = host.status();
  if (host.ok()) {
    for (Governed& governed : governed_) govern(governed, now, *host);
    status = commit(*host);
  }
  if (!status.ok() && status.message() != last_problem_)
    log::warning("state of the host: {}", status.message());
  last_problem_ = status.ok() ? "" : status.message();
}

void HostWatch::govern(Governed& governed, SteadyTime now, const HostState& host) {
  memory::MemoryService& service = governed.watched.server->service();
  const auto change = governed.governor.update(now, host, service.counters().memory.bytes);
  if (!change) return;
  ltm::MemoryLimits limits = governed.watched.limits;
  limits.bytes = change->after_bytes;
  const Status status = service.set_limits(limits);
  log::info("server '{}': working memory may take {} MiB, {} before; {}{}",
            name_of(governed.watched), change->after_bytes / kMebibyte,
            change->before_bytes / kMebibyte, change->reason,
            status.ok() ? "" : ", but: " + status.message());
}

RamLimit HostWatch::limit_of_all() const {
  if (governed_.size() == 1) return governed_.front().governor.limit();
  RamLimit all;
  for (const Governed& governed : governed_) {
    const RamLimit& limit = governed.governor.limit();
    all.bytes += limit.bytes;
    all.reason += fmt::format("{}{}: {} MiB, {}", all.reason.empty() ? "" : "; ",
                              name_of(governed.watched), limit.bytes / kMebibyte, limit.reason);
  }
  return all;
}

Status HostWatch::commit(const HostState& host) {
  const auto holder = std::ranges::find_if(
      governed_, [](const Governed& governed) { return governed.watched.has_system_state; });
  if (holder == governed_.end()) return {};
  const Time now = system_now();
  ltm::Instance instance{to_data(host, limit_of_all()),
                         {.created = now, .sent = now, .provider = "engram"}};
  return holder->watched.server->commit({{{entity_, now, {std::move(instance)}}}});
}

}  // namespace engram::server
