#include "tests/chaos/child.hpp"

#include "driver/virtual/control_socket.hpp"

#include <fmt/format.h>

#include <array>
#include <csignal>
#include <deque>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <poll.h>
#include <stdexcept>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::chaos {

namespace {

constexpr std::size_t log_lines_shown = 40;
constexpr int fifo_bytes = 1 << 20;

/// Runs the program under test; what it logs goes to a file, so that no pipe can fill up.
std::unique_ptr<test::Process>
run_program(const std::string& log, const std::vector<std::string>& arguments) {
    std::vector<std::string>
        all{"/bin/sh", "-c", R"(log=$1; shift; exec "$@" 2>"$log")", "sh", log, test::program()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return std::make_unique<test::Process>(all);
}

/// What follows "://", without the slash at the end.
std::string address_in(std::string line) {
    line.erase(0, line.find("://") + 3);
    while (line.ends_with('/')) {
        line.pop_back();
    }
    return line;
}

int make_fifo(const std::string& path) {
    if (::mkfifo(path.c_str(), S_IRUSR | S_IWUSR) != 0) {
        throw std::runtime_error("no FIFO at " + path);
    }
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    (void)::fcntl(descriptor, F_SETPIPE_SZ, fifo_bytes);  // a smaller one will do
    return descriptor;
}

}  // namespace

Lidar::Lidar(const test::ScratchDirectory& scratch, std::string model, std::size_t number)
    : model_(std::move(model))
    , persona_(virtual_lidar::find_persona(model_))
    , link_(scratch.file(fmt::format("lidar{}", number)))
    , control_(scratch.file(fmt::format("control{}", number))) {
    if (persona_ == nullptr) {
        throw std::runtime_error("there is no model " + model_);
    }
    const auto truth = scratch.file(fmt::format("truth{}", number));
    truth_ = make_fifo(truth);
    process_ = run_program(
        "/dev/null",
        {"virtual", "--model", model_, "--link", link_, "--control", control_, "--truth", truth}
    );
}

Lidar::~Lidar() {
    process_.reset();
    ::close(truth_);
}

void Lidar::wait_until_ready() const {
    const auto deadline = std::chrono::steady_clock::now() + test::patience;
    while (!virtual_lidar::ask_control_socket(control_, "status")) {
        if (std::chrono::steady_clock::now() > deadline) {
            throw std::runtime_error("a virtual lidar does not start");
        }
        ::poll(nullptr, 0, 20);
    }
}

std::string Lidar::tell(const std::string& command) const {
    const auto answer = virtual_lidar::ask_control_socket(control_, command);
    if (!answer) {
        throw std::runtime_error(answer.error().cause);
    }
    return *answer == "ok" ? "" : *answer;
}

Gateway::Gateway(const test::ScratchDirectory& scratch, const std::vector<std::string>& links)
    : log_(scratch.file("gateway.log")) {
    std::vector<std::string> arguments{
        "serve",
        "--http",
        "127.0.0.1:0",
        "--tcp",
        "127.0.0.1:0",
        "--state-dir",
        scratch.file("state")};
    for (const auto& link : links) {
        arguments.insert(arguments.end(), {"--lidar", link});
    }
    process_ = run_program(log_, arguments);
    http_ = address_in(process_->wait_for_output("page: "));
    tcp_ = address_in(process_->wait_for_output("tcp: "));
}

bool Gateway::lives() const {
    std::ifstream stat(fmt::format("/proc/{}/stat", process_->pid()));
    std::string text;
    std::getline(stat, text);
    const auto name_end = text.rfind(')');
    return name_end != std::string::npos && text.size() > name_end + 2 && text[name_end + 2] != 'Z';
}

std::size_t Gateway::descriptors() const {
    std::error_code gone;
    const std::filesystem::directory_iterator all(
        fmt::format("/proc/{}/fd", process_->pid()),
        gone
    );
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

std::string Gateway::log_tail() const {
    std::ifstream log(log_);
    std::deque<std::string> lines;
    for (std::string line; std::getline(log, line);) {
        lines.push_back(std::move(line));
        if (lines.size() > log_lines_shown) {
            lines.pop_front();
        }
    }
    std::string text;
    for (const auto& line : lines) {
        text += line + "\n";
    }
    return text;
}

int Gateway::stop() {
    process_->signal(SIGTERM);
    return process_->wait();
}

Rig::Rig(std::size_t count) {
    constexpr std::array models{"a1m8", "c1", "s2", "a3m1"};
    std::vector<std::string> links;
    for (std::size_t i = 0; i < count; ++i) {
        lidars.push_back(std::make_unique<Lidar>(scratch, models.at(i % models.size()), i));
        links.push_back(lidars.back()->link());
    }
    for (const auto& lidar : lidars) {
        lidar->wait_until_ready();
    }
    gateway = std::make_unique<Gateway>(scratch, links);
}

}  // namespace sweepcast::chaos
