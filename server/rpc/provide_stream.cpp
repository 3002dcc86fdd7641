// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/provide_stream.h"

#include "server/wire/byte_message.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

skills::SkillReport report_of(const v1::SkillReport& message) {
  skills::SkillReport report{.execution = message.execution(),
                             .data_json = message.data_json(),
                             .links = {message.links().begin(), message.links().end()},
                             .is_end = message.end() != v1::SkillReport::NONE,
                             .reason = message.reason()};
  if (message.end() == v1::SkillReport::FAILURE) report.outcome = skills::SkillOutcome::kFailure;
  if (message.end() == v1::SkillReport::STOP) report.outcome = skills::SkillOutcome::kStop;
  return report;
}

}  // namespace

/// Sends what the skill memory tells the provider, as long as the stream is there.
class ProvideStream::Link final : public skills::ProviderLink {
 public:
  explicit Link(std::weak_ptr<ProvideStream> stream) : stream_(std::move(stream)) {}

  void welcome(const Status& status) override {
    const auto stream = stream_.lock();
    if (!stream) return;
    // What is refused at first ends the stream; what is refused later leaves the rest as it is.
    if (!status.ok() && !is_welcome_) return stream->end(status);
    is_welcome_ = true;
    v1::ProvideReply reply;
    *reply.mutable_taken() = to_outcome(status);
    stream->send(to_bytes(reply));
  }

  void start(const skills::SkillStart& start) override {
    v1::ProvideReply reply;
    v1::ProvideReply::Start& message = *reply.mutable_start();
    message.set_execution(start.execution);
    message.set_skill(start.skill);
    message.set_parameters_json(start.parameters_json);
    message.set_request(start.request);
    if (const auto stream = stream_.lock()) stream->send(to_bytes(reply));
  }

  void stop(const std::string& execution, const std::string& reason) override {
    v1::ProvideReply reply;
    reply.mutable_stop()->set_execution(execution);
    reply.mutable_stop()->set_reason(reason);
    if (const auto stream = stream_.lock()) stream->send(to_bytes(reply));
  }

 private:
  const std::weak_ptr<ProvideStream> stream_;
  bool is_welcome_ = false;  ///< Used by the thread of the skill memory alone.
};

Status ProvideStream::check() {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId memory, ltm::MemoryId::parse(skills::kSkillMemory));
  return who_.check(Right::kWrite, memory);
}

Status ProvideStream::hello(const v1::ProvideRequest& message) {
  ENGRAM_RETURN_IF_ERROR(context_.audited(who_.name(), "provide", message.provider(), check()));
  if (!context_.skills)
    return failed_precondition(
        "server '{}': has no skill memory; the server of the memory '{}' has it",
        context_.service.options().name, skills::kSkillMemory);
  ENGRAM_ASSIGN_OR_RETURN(skills_, context_.skills());
  const auto self = std::static_pointer_cast<ProvideStream>(shared_from_this());
  session_ =
      skills_->connect(std::make_shared<Link>(self),
                       {message.provider(), {message.added().begin(), message.added().end()}});
  return {};
}

Status ProvideStream::on_request(grpc::ByteBuffer& request) {
  v1::ProvideRequest message;
  if (Status status = read_message(request, message); !status.ok()) {
    context_.metrics.broken_requests.add();
    return status;
  }
  if (skills_ == nullptr) return hello(message);
  // The token may have expired since.
  ENGRAM_RETURN_IF_ERROR(check());
  if (message.added_size() + message.removed_size() > 0)
    skills_->change(session_, {{message.added().begin(), message.added().end()},
                               {message.removed().begin(), message.removed().end()}});
  if (message.has_report()) skills_->report(session_, report_of(message.report()));
  return {};
}

void ProvideStream::on_end() {
  if (skills_ != nullptr) skills_->disconnect(session_);
}

}  // namespace engram::server
