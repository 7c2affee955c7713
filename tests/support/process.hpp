// Process: runs a program as a user would, reads what it prints, signals it, and waits for it.
// No process outlives its test, and none ends abnormally without the test failing.
#pragma once

#include <chrono>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sweepcast::test {

/// How long any one event may take before the test gives up on it. Only a test that fails waits
/// this long, so a busy machine and a sanitizer have room.
inline constexpr std::chrono::seconds patience{60};

class Process {
public:
    /// Starts `arguments[0]`. Standard output and standard error are kept. No signal is ignored at
    /// the start, whatever this process ignores.
    explicit Process(const std::vector<std::string>& arguments);
    /// Ends the program by SIGTERM if it still runs. The test fails, and shows the log, if the
    /// program does not end in time, or ends with an exit status other than 0. The program may die
    /// of SIGTERM, or of a signal that the test itself sent.
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// Waits for a line on standard output that contains `text` and returns it. Lines before it are
    /// passed over. Throws if the program ends first or does not print it in time.
    std::string wait_for_output(const std::string& text) { return wait_for_line(out_, text); }
    /// The same for standard error, where the log goes.
    std::string wait_for_log(const std::string& text) { return wait_for_line(err_, text); }

    void signal(int number);

    /// Waits for the end and returns the exit code, or 128 + the signal's number. Throws if it does
    /// not end in time.
    int wait();

    /// Everything printed that no wait_for_... has passed over; after wait(), to the end.
    [[nodiscard]] std::string rest_of_output();
    [[nodiscard]] std::string rest_of_log();

    [[nodiscard]] pid_t pid() const { return pid_; }
    /// Resident memory in bytes.
    [[nodiscard]] std::size_t resident_bytes() const;

private:
    struct Pipe {
        int descriptor{-1};
        std::string unread;
        bool ended{};
    };
    using Deadline = std::chrono::steady_clock::time_point;

    std::string wait_for_line(Pipe& from, const std::string& text);
    /// Reads what both pipes have, waiting for some until the deadline. False if the deadline
    /// passed.
    bool read_more(Deadline deadline);
    /// Reads until both pipes have ended. False if the deadline passed.
    bool read_to_end(Deadline deadline);
    /// Reaps the program. Returns its exit status, or 128 + the number of the signal it died of.
    int reap();
    /// Ends the program; returns what is wrong with how it ended, or an empty string.
    std::string end();

    std::string name_;
    int signalled_{};  ///< the last signal that the test sent
    pid_t pid_{-1};
    Pipe out_;
    Pipe err_;
};

}  // namespace sweepcast::test
