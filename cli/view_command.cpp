// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "cli/ask_model.h"
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/remote.h"
#include "ltm/core/child.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/core/private_file.h"
#include "memory/model_loader.h"
#include "viewer/viewer.h"

namespace engram::cli {

namespace {

constexpr const char* kViewFooter =
    R"(Shows memories in a browser, until Ctrl-C: what there is, past and future on one time axis. Of
several, the page shows the one that is chosen there. The page is at the URL that is printed first.
It has a token, so keep it to yourself. Only this machine reaches it; from another one, tunnel:
ssh -L 8200:127.0.0.1:8200 robot. Nothing is changed, and no other place is asked for anything. See
docs/viewer.md.

Examples:
  engram view robot.engram
  engram view robot.engram --open
  engram view monday.engram tuesday.engram
  engram view robot.engram --listen 127.0.0.1:8200
  engram view --server 127.0.0.1:50051
  engram view robot.engram --json
  engram view robot.engram --embed http://localhost:8888)";

struct ViewArguments {
  std::vector<std::string> stores;
  RemoteArguments remote;
  std::string listen = "127.0.0.1:0";
  std::string embed;
  bool is_opened = false;
  bool is_noted = false;
  bool is_json = false;
};

/// A page that leads to the URL, and that nobody else can read: the arguments of a browser are
/// shown to all users of a machine. It is removed at the end.
class LeadingPage {
 public:
  static Result<std::unique_ptr<LeadingPage>> create(const std::string& url) {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    const std::filesystem::path folder =
        runtime != nullptr ? runtime : std::filesystem::temp_directory_path();
    std::unique_ptr<LeadingPage> page(
        new LeadingPage(folder / fmt::format("engram-view-{}.html", getpid())));
    ENGRAM_RETURN_IF_ERROR(create_private_file(
        page->path_, fmt::format("<!doctype html><meta http-equiv=\"refresh\" content=\"0; "
                                 "url={}\"><a href=\"{}\">Engram</a>\n",
                                 url, url)));
    return page;
  }
  LeadingPage(const LeadingPage&) = delete;
  LeadingPage& operator=(const LeadingPage&) = delete;
  ~LeadingPage() {
    if (const Status removed = remove_file(path_); !removed.ok())
      log::warning("{}", removed.message());
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit LeadingPage(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path path_;
};

/// A machine without a desktop has no browser to open; the URL was printed all the same.
std::unique_ptr<LeadingPage> open_browser(const std::string& url) {
  auto page = LeadingPage::create(url);
  if (!page.ok()) {
    log::warning("--open: {}", page.status().message());
    return nullptr;
  }
  const auto child = start_child({"xdg-open", (*page)->path().string()}, {});
  if (!child.ok()) {
    log::warning("--open: {}", child.status().message());
    return nullptr;
  }
  std::thread([pid = *child] { waitpid(pid, nullptr, 0); }).detach();
  return std::move(*page);
}

void wait_until_interrupted() {
  Mutex mutex;  // `wake` needs a mutex; this one guards nothing.
  StoppableCondition wake;
  const MutexLock lock(mutex);
  wake.wait(mutex, interrupt_token(), [] { return false; });
}

std::string name_of(const std::string& store, const ViewArguments& arguments) {
  if (!store.empty()) {
    const std::filesystem::path path = std::filesystem::path(store).lexically_normal();
    return (path.has_filename() ? path : path.parent_path()).filename().string();
  }
  if (!arguments.remote.names.empty()) return arguments.remote.names;
  return arguments.remote.server.empty() ? "server" : arguments.remote.server;
}

ExitCode run(const ViewArguments& arguments) {
  // A server is asked where no store is named.
  const std::vector<std::string> sources =
      arguments.stores.empty() ? std::vector<std::string>{""} : arguments.stores;
  for (const std::string& source : sources)
    if (const Status named = check_source(source, arguments.remote); !named.ok())
      return wrong_usage(named);
  finish_after_interrupt();
  viewer::Viewer::Options options;
  for (const std::string& source : sources) {
    viewer::ViewedMemory::Options& memory = options.memories.emplace_back();
    memory.name = name_of(source, arguments);
    memory.store = source;
    memory.loader = model_loader();
    memory.open_reader = [source] { return reader_of({}, source); };
    memory.open = [source, arguments](bool prefers_latents) {
      return open_memory(source,
                         {.is_read_only = true,
                          .prefers_latents = prefers_latents,
                          .notes_reads = arguments.is_noted},
                         arguments.remote);
    };
  }
  options.listen = arguments.listen;
  options.embedding_origin = arguments.embed;
  const auto viewer = viewer::Viewer::start(std::move(options));
  if (!viewer.ok())
    return viewer.status().code() == StatusCode::kInvalidArgument ? wrong_usage(viewer.status())
                                                                  : fail(viewer.status());
  const std::string url = (*viewer)->url();
  if (arguments.is_json)
    print(Json{{"url", url}}.dump());
  else
    print(url);
  std::fflush(stdout);
  const auto page = arguments.is_opened ? open_browser(url) : nullptr;
  wait_until_interrupted();
  return ExitCode::kDone;
}

}  // namespace

void add_view_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand("view", "See memories in the browser");
  command->footer(kViewFooter);
  command->add_option("stores", arguments->stores, "Stores; none where a server is asked");
  add_remote_options(*command, arguments->remote);
  command
      ->add_option("--listen", arguments->listen,
                   "HOST:PORT of this machine, port 0: any that is free")
      ->capture_default_str();
  command->add_flag("--open", arguments->is_opened, "Open it in the browser (xdg-open)");
  command->add_option("--embed", arguments->embed,
                      "Origin whose pages may show it in a frame, such as that of a notebook");
  command->add_flag("--noted", arguments->is_noted,
                    "Note in the store what is looked at (docs/forgetting.md)");
  command->add_flag("--json", arguments->is_json, "The URL as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
