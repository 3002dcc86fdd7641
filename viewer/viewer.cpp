// SPDX-License-Identifier: Apache-2.0
#include "viewer/viewer.h"

#include <exception>

#include "ltm/core/log.h"
#include "server/access/endpoint.h"
#include "viewer/page_assets.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

Result<server::Endpoint> local_endpoint(const std::string& text) {
  ENGRAM_ASSIGN_OR_RETURN(server::Endpoint endpoint, server::Endpoint::parse(text));
  if (endpoint.kind() != server::Endpoint::Kind::kTcp)
    return invalid_argument("'{}': browsers need HOST:PORT", text);
  if (!endpoint.is_local())
    return failed_precondition(
        "'{}': other machines could reach it, and the viewer has neither TLS nor grants "
        "(docs/access.md); listen at 127.0.0.1, and reach it from elsewhere by 'ssh -L'",
        text);
  return endpoint;
}

}  // namespace

Result<std::unique_ptr<Viewer>> Viewer::start(Options options) {
  if (!options.embedding_origin.empty() && !VisitorGate::is_origin(options.embedding_origin))
    return invalid_argument("'{}': is no origin, needs one such as http://localhost:8888",
                            options.embedding_origin);
  ENGRAM_ASSIGN_OR_RETURN(const server::Endpoint endpoint, local_endpoint(options.listen));
  const std::string address = endpoint.host() == "localhost" ? "127.0.0.1" : endpoint.host();
  std::unique_ptr<Viewer> viewer(new Viewer());
  ENGRAM_CHECK(!options.memories.empty(), "found no memory to show");
  for (ViewedMemory::Options& memory : options.memories) {
    ENGRAM_ASSIGN_OR_RETURN(auto opened, ViewedMemory::open(std::move(memory)));
    viewer->memories_.push_back(std::move(opened));
  }
  ENGRAM_ASSIGN_OR_RETURN(viewer->gateway_,
                          Gateway::listen({.address = address, .port = endpoint.port()}));
  ENGRAM_ASSIGN_OR_RETURN(std::string token, server::make_token());
  viewer->gate_ = std::make_unique<VisitorGate>(
      VisitorGate::Options{.host = address,
                           .port = viewer->gateway_->port(),
                           .token = std::move(token),
                           .embedding_origin = std::move(options.embedding_origin)});
  const Viewer* self = viewer.get();
  viewer->gateway_->serve(
      [self](const HttpRequest& request) { return self->respond(request); },
      [self](const HttpRequest& request) { return self->stop_socket(request); });
  for (size_t number = 0; number < viewer->memories_.size(); ++number)
    if (!viewer->memories_[number]->is_store()) viewer->follow(number);
  return viewer;
}

Viewer::~Viewer() {
  // Nobody waits for these any more.
  for (const auto& memory : memories_) memory->long_questions().call_off_all();
}

void Viewer::follow(size_t number) {
  Gateway* const gateway = gateway_.get();
  SubscriptionHandlers handlers{
      .on_snapshots =
          [gateway, number](const std::vector<ToldSnapshot>& told) {
            nlohmann::ordered_json ids = nlohmann::ordered_json::array();
            for (const ToldSnapshot& one : told) ids.push_back(one.snapshot.id().to_string());
            gateway->publish(
                json_text({{"kind", "commit"}, {"memory", number}, {"ids", std::move(ids)}}),
                told.size());
          },
      .on_lost =
          [gateway, number](uint64_t lost) {
            gateway->publish(json_text({{"kind", "dropped"}, {"memory", number}, {"count", lost}}),
                             lost);
          },
      .on_interrupted =
          [gateway, number](const Status& status) {
            gateway->publish(
                json_text(
                    {{"kind", "interrupted"}, {"memory", number}, {"message", status.message()}}),
                0);
          }};
  auto subscription =
      memories_[number]->memory().subscribe({.with_data = false}, std::move(handlers));
  if (subscription.ok())
    subscriptions_.push_back(*std::move(subscription));
  else
    log::warning("viewer: what is committed is not shown by itself: {}",
                 subscription.status().message());
}

std::optional<HttpResponse> Viewer::stop_socket(const HttpRequest& request) const {
  const auto target = RequestTarget::parse(request.target);
  auto refused = target.ok() ? gate_->stop(request, *target) : error_response(target.status());
  if (!refused) refused = gate_->stop_socket(request);
  if (!refused && target->path() != "/api/live")
    refused = error_response(not_found("there is no such connection"));
  if (refused)
    for (const auto& header : gate_->headers()) refused->headers.push_back(header);
  return refused;
}

HttpResponse Viewer::names() const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& memory : memories_) {
    list.push_back({{"name", memory->options().name}, {"is_live", !memory->is_store()}});
    if (memory->is_store()) list.back()["path"] = memory->options().store.string();
  }
  HttpResponse response = json_response({{"memories", std::move(list)}});
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

Result<HttpResponse> Viewer::page_or_answer(const HttpRequest& request,
                                            const RequestTarget& target) const {
  if (auto page = page_response(request, target.path())) return *std::move(page);
  if (target.path() == "/api/memories") return names();
  ENGRAM_ASSIGN_OR_RETURN(
      const int64_t number,
      target.integer("memory", 0, static_cast<int64_t>(memories_.size()) - 1, 0));
  return answer(*memories_[static_cast<size_t>(number)], request, target);
}

HttpResponse Viewer::respond(const HttpRequest& request) const {
  HttpResponse response;
  try {
    const auto target = RequestTarget::parse(request.target);
    if (!target.ok()) {
      response = error_response(target.status());
    } else if (auto stopped = gate_->stop(request, *target)) {
      response = *std::move(stopped);
    } else {
      auto made = page_or_answer(request, *target);
      response = made.ok() ? std::move(*made) : error_response(made.status());
    }
  } catch (const std::exception& error) {
    // Memory that is not there, most of all; the next request may be smaller.
    log::warning("viewer: a request failed: {}", error.what());
    response = error_response(500, resource_exhausted("the request failed: {}", error.what()));
  }
  for (const auto& header : gate_->headers()) response.headers.push_back(header);
  return response;
}

}  // namespace engram::viewer
