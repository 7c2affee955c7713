#include "tests/support/process.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <optional>
#include <poll.h>
#include <spawn.h>
#include <stdexcept>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

extern char** environ;

namespace sweepcast::test {

namespace {

using Clock = std::chrono::steady_clock;

std::array<int, 2> make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
        throw std::system_error(errno, std::generic_category(), "pipe");
    }
    return ends;
}

/// Takes the first line out of `text`, if there is a whole one.
std::optional<std::string> take_line(std::string& text) {
    const auto end = text.find('\n');
    if (end == std::string::npos) {
        return std::nullopt;
    }
    auto line = text.substr(0, end);
    text.erase(0, end + 1);
    return line;
}

int milliseconds_until(Clock::time_point deadline) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    return static_cast<int>(std::max<long>(left.count(), 0));
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments)
    : name_(std::filesystem::path(arguments.front()).filename()) {
    if (arguments.size() > 1) {
        name_ += " " + arguments[1];
    }
    std::vector<char*> argv;
    for (const auto& argument : arguments) {
        argv.push_back(const_cast<char*>(argument.c_str())
        );  // NOLINT(cppcoreguidelines-pro-type-const-cast): posix_spawn does not write
    }
    argv.push_back(nullptr);

    const auto out = make_pipe();
    const auto err = make_pipe();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const int failed = posix_spawn(&pid_, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(out[1]);
    close(err[1]);
    out_.descriptor = out[0];
    err_.descriptor = err[0];
    if (failed != 0) {
        pid_ = -1;
        throw std::system_error(
            failed,
            std::generic_category(),
            "cannot start " + arguments.front()
        );
    }
}

Process::~Process() {
    if (pid_ > 0) {
        if (const auto fault = end(); !fault.empty()) {
            ADD_FAILURE() << name_ << " " << fault << "; its log ends with:\n" << err_.unread;
        }
    }
    close(out_.descriptor);
    close(err_.descriptor);
}

void Process::signal(int number) {
    kill(pid_, number);
    signalled_ = number;
}

int Process::wait() {
    if (!read_to_end(Clock::now() + patience)) {
        throw std::runtime_error(name_ + " does not end; its log ends with:\n" + err_.unread);
    }
    return reap();
}

bool Process::read_to_end(Deadline deadline) {
    while (!out_.ended || !err_.ended) {
        if (!read_more(deadline)) {
            return false;
        }
    }
    return true;
}

int Process::reap() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string Process::end() {
    kill(pid_, SIGTERM);
    if (signalled_ == SIGSTOP) {
        // A stopped process sees no other signal. Only then: a process that runs may be in the
        // middle of its leak check, where SIGCONT takes away the SIGSTOP that the check waits for.
        kill(pid_, SIGCONT);
    }
    if (!read_to_end(Clock::now() + patience)) {
        kill(pid_, SIGKILL);
        reap();
        return "did not end after SIGTERM";
    }
    const int status = reap();
    const bool as_told = status == 128 + SIGTERM || (signalled_ != 0 && status == 128 + signalled_);
    if (status == 0 || as_told) {
        return "";
    }
    return status > 128 ? "died of signal " + std::to_string(status - 128)
                        : "ended with exit status " + std::to_string(status);
}

std::string Process::rest_of_output() {
    return std::exchange(out_.unread, "");
}

std::string Process::rest_of_log() {
    return std::exchange(err_.unread, "");
}

std::size_t Process::resident_bytes() const {
    std::ifstream statm("/proc/" + std::to_string(pid_) + "/statm");
    std::size_t total = 0;
    std::size_t resident = 0;
    statm >> total >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::string Process::wait_for_line(Pipe& from, const std::string& text) {
    const auto deadline = Clock::now() + patience;
    std::string passed;
    for (;;) {
        while (auto line = take_line(from.unread)) {
            if (line->find(text) != std::string::npos) {
                return *line;
            }
            passed += *line + "\n";
        }
        if (from.ended || !read_more(deadline)) {
            throw std::runtime_error(
                "the program did not print \"" + text + "\" but:\n" + passed + from.unread +
                "\nand its log:\n" + err_.unread
            );
        }
    }
}

bool Process::read_more(Deadline deadline) {
    std::array<pollfd, 2> polled{
        pollfd{out_.ended ? -1 : out_.descriptor, POLLIN, 0},
        pollfd{err_.ended ? -1 : err_.descriptor, POLLIN, 0}};
    if (poll(polled.data(), polled.size(), milliseconds_until(deadline)) <= 0) {
        return false;
    }
    for (auto* pipe : {&out_, &err_}) {
        const auto& result = polled[pipe == &out_ ? 0 : 1];
        if (result.revents == 0) {
            continue;
        }
        std::array<char, 65536> chunk;
        const auto got = read(pipe->descriptor, chunk.data(), chunk.size());
        if (got > 0) {
            pipe->unread.append(chunk.data(), static_cast<std::size_t>(got));
        } else {
            pipe->ended = true;
        }
    }
    return true;
}

}  // namespace sweepcast::test
