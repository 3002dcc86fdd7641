// SPDX-License-Identifier: Apache-2.0
#include "cli/remote_forget.h"

#include "cli/confirm.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/remote_client.h"
#include "ltm/core/printable.h"
#include "reports/plain/text.h"

namespace engram::cli {

using reports::count_text;
using server::Forgotten;

namespace {

Json entities_json(const Forgotten& forgotten) {
  Json entities = Json::array();
  for (const Forgotten::OfEntity& one : forgotten.entities)
    entities.push_back({{"id", one.entity},
                        {"forgotten", one.snapshots},
                        {"first_ns", to_ns(one.first)},
                        {"last_ns", to_ns(one.last)}});
  return entities;
}

Json counted_json(const Forgotten& forgotten) {
  return {{"snapshots", forgotten.snapshots},
          {"notes", forgotten.notes},
          {"entities", entities_json(forgotten)}};
}

Json done_json(const Forgotten& forgotten) {
  // It comes from another process, so it may be no JSON.
  const Json erased = Json::parse(forgotten.erased_json, nullptr, false);
  return {{"snapshots", forgotten.snapshots},
          {"from_memory", forgotten.from_memory},
          {"never_stored", forgotten.never_stored},
          {"from_store", forgotten.from_store},
          {"erased", erased.is_discarded() ? Json() : erased},
          {"entities", entities_json(forgotten)}};
}

void print_counted(const Forgotten& forgotten) {
  for (const Forgotten::OfEntity& one : forgotten.entities) {
    print(printable(one.entity));
    print(fmt::format("  goes   {} snapshots, {} to {}", count_text(one.snapshots),
                      to_string(one.first), to_string(one.last)));
  }
  print(fmt::format("In all {} snapshots", count_text(forgotten.snapshots)));
  for (const std::string& note : forgotten.notes) print("Note: " + printable(note));
}

void print_done(const Forgotten& forgotten) {
  print(fmt::format(
      "{} snapshots {}: {} from working memory, {} of them not stored yet; {} from the "
      "store",
      count_text(forgotten.snapshots), forgotten.erased_json.empty() ? "forgotten" : "erased",
      count_text(forgotten.from_memory), count_text(forgotten.never_stored),
      count_text(forgotten.from_store)));
  const Json erased = Json::parse(forgotten.erased_json, nullptr, false);
  if (!erased.is_object()) return;
  if (const auto report = erased.find("report"); report != erased.end() && report->is_string())
    print("The report is in the server's store: " + printable(report->get<std::string>()));
}

std::string server_question(const RemoteForget& what, uint64_t snapshots) {
  return what.erases ? fmt::format(
                           "Erase {} snapshots, so that no file of the server holds anything of "
                           "them?",
                           snapshots)
                     : fmt::format("Forget {} snapshots? They cannot be brought back.", snapshots);
}

}  // namespace

ExitCode forget_on_server(const RemoteForget& what) {
  const auto client = open_client(what.remote);
  if (!client.ok()) return fail(client.status());
  ProgressLine progress;
  server::ForgetCall call{what.targets, what.erases, true, progress.sink(), interrupt_token()};
  const auto counted = (*client)->forget(call);
  progress.finish();
  if (!counted.ok()) return fail(counted.status());
  Json json{{"plan", counted_json(*counted)}};
  if (!what.is_json) print_counted(*counted);
  if (what.is_dry_run) {
    if (what.is_json) print_json(json);
    return ExitCode::kDone;
  }
  if (!what.is_confirmed && !is_confirmed(server_question(what, counted->snapshots)))
    return fail(cancelled("forget: nothing was changed"));
  call.is_dry_run = false;
  const auto done = (*client)->forget(call);
  progress.finish();
  if (!done.ok()) return fail(done.status());
  json["done"] = done_json(*done);
  if (what.is_json)
    print_json(json);
  else
    print_done(*done);
  return ExitCode::kDone;
}

}  // namespace engram::cli
