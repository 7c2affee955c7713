// `sweepcast watch`: subscribes to a gateway and prints what comes. The stream's reference client.
#include "server/cli/command.hpp"
#include "server/cli/stop_signals.hpp"
#include "server/cli/watch_output.hpp"
#include "server/client/stream_client.hpp"
#include "server/frame/frame_decoder.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/error.hpp>
#include <fmt/core.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <string>

namespace sweepcast::cli {

namespace asio = boost::asio;
using namespace std::chrono_literals;

namespace {

constexpr auto connect_limit = 5000ms;

struct WatchArguments {
    std::string url{"tcp://127.0.0.1:8081"};
    std::string lidar;
    std::string compression{"zstd"};
    bool csv{};
    bool json{};
    std::uint64_t sweeps{std::numeric_limits<std::uint64_t>::max()};
};

std::unique_ptr<WatchOutput> make_output(const WatchArguments& arguments) {
    if (arguments.csv) {
        return make_csv_output();
    }
    return arguments.json ? make_json_output() : make_table_output();
}

device::CapturedSweep to_captured(frame::DecodedScan scan, const v1::Frame& from) {
    device::CapturedSweep captured;
    if (!scan.sweep.samples.empty()) {
        captured.monotonic_to_unix =
            scan.first_unix - scan.sweep.samples.front().time.time_since_epoch();
    }
    captured.sweep = std::move(scan.sweep);
    captured.lidar = from.lidar();
    captured.sequence = from.sequence();
    captured.mode = scan.mode;
    captured.answer_type = scan.answer_type;
    captured.sample_duration =
        std::chrono::duration_cast<std::chrono::microseconds>(scan.sample_duration);
    return captured;
}

/// Takes in what the gateway says.
class Watcher {
public:
    explicit Watcher(const WatchArguments& arguments)
        : output_(make_output(arguments))
        , sweeps_left_(arguments.sweeps) {}

    /// False once there is nothing more to wait for.
    bool take(const v1::ServerMessage& message) {
        const bool goes_on = take_in(message);
        return can_write() && goes_on;
    }

    /// Prints what is left to print.
    void end() {
        if (!output_->write_error()) {
            output_->on_end();
            can_write();
        }
    }

    bool fail(const Problem& problem) {
        exit_code_ = report(problem);
        return false;
    }

    [[nodiscard]] int exit_code() const { return exit_code_; }

private:
    bool take_in(const v1::ServerMessage& message) {
        switch (message.message_case()) {
        case v1::ServerMessage::kHello:
            output_->on_hello(message.hello());
            return true;
        case v1::ServerMessage::kLidar:
            output_->on_lidar(message.lidar());
            return true;
        case v1::ServerMessage::kFrame:
            return take_in(message.frame());
        case v1::ServerMessage::kStats:
            output_->on_stats(message.stats());
            return true;
        case v1::ServerMessage::kError:
            return fail({{}, message.error().message(), message.error().hint()});
        case v1::ServerMessage::kClosing:
            return fail({{}, "the gateway ends the connection: " + message.closing().reason(), ""});
        case v1::ServerMessage::kSubscribed:
        case v1::ServerMessage::MESSAGE_NOT_SET:
            return true;  // of a newer gateway: nothing for us
        }
        return true;
    }

    bool take_in(const v1::Frame& frame) {
        auto scan = decoder_.decode(frame);
        if (!scan) {
            return fail(
                {scan.error(),
                 "a frame does not decode: " + scan.error().message(),
                 "is the gateway of another version?"}
            );
        }
        output_->on_sweep(to_captured(std::move(*scan), frame), frame.ByteSizeLong());
        return --sweeps_left_ > 0;
    }

    /// False, and the exit code says so, if what was printed did not get through.
    bool can_write() {
        const auto failed = output_->write_error();
        if (!failed) {
            return true;
        }
        if (failed == boost::system::errc::broken_pipe) {
            exit_code_ = 1;  // the reader has had enough, as `| head`: nothing to tell anyone
            return false;
        }
        return fail({failed, "cannot write to standard output: " + failed.message(), ""});
    }

    std::unique_ptr<WatchOutput> output_;
    frame::FrameDecoder decoder_;
    std::uint64_t sweeps_left_;
    int exit_code_{};
};

asio::awaitable<void>
receive_all(client::StreamUrl url, const WatchArguments& arguments, Watcher& watcher) {
    auto connected = co_await client::StreamClient::connect(url, connect_limit);
    if (!connected) {
        watcher.fail(connected.error());
        co_return;
    }
    auto& client = **connected;
    const bool url_says_it = url.target.find('?') != std::string::npos;
    if (!url_says_it) {
        v1::Subscribe wish;
        wish.set_lidar(arguments.lidar);
        wish.set_compression(arguments.compression == "none" ? v1::NONE : v1::ZSTD);
        if (const auto sent = co_await client.subscribe(wish); !sent) {
            watcher.fail(
                {sent.error(), "the gateway ended the connection: " + sent.error().message(), ""}
            );
            co_return;
        }
    }
    for (;;) {
        const auto message = co_await client.receive();
        if (!message && message.error() == asio::error::operation_aborted) {
            co_return;  // told to stop
        }
        if (!message) {
            watcher.fail({message.error(), "the connection ended: " + message.error().message(), ""}
            );
            co_return;
        }
        if (!watcher.take(**message)) {
            co_return;
        }
    }
}

int watch(const WatchArguments& arguments) {
    auto url = client::parse_stream_url(arguments.url);
    if (!url) {
        return report(url.error());
    }
    std::signal(SIGPIPE, SIG_IGN);  // a reader that goes is an error of a write
    Watcher watcher(arguments);
    StopSignals signals;
    try {
        signals.run(receive_all(std::move(*url), arguments, watcher));
    } catch (const std::exception& failure) {
        watcher.fail({{}, fmt::format("cannot go on: {}", failure.what()), ""});
    }
    watcher.end();
    return watcher.exit_code();
}

}  // namespace

void add_watch_command(CLI::App& app, int& exit_code) {
    auto arguments = std::make_shared<WatchArguments>();
    auto& command = *app.add_subcommand("watch", "Subscribe to a gateway and print what comes");
    command
        .add_option(
            "url",
            arguments->url,
            "tcp://HOST:PORT or ws://HOST:PORT[/api/v1/stream?lidar=ID&compression=none]"
        )
        ->capture_default_str();
    command.add_option(
        "--lidar",
        arguments->lidar,
        "Id of the lidar; without it all (where the URL has no query)"
    );
    command
        .add_option(
            "--compression",
            arguments->compression,
            "zstd or none (where the URL has no query)"
        )
        ->check(CLI::IsMember({"zstd", "none"}))
        ->capture_default_str();
    auto* csv = command.add_flag("--csv", arguments->csv, "Print a line a sample");
    command.add_flag("--json", arguments->json, "Print a line of JSON a sweep")->excludes(csv);
    command.add_option("--sweeps", arguments->sweeps, "End after so many sweeps")
        ->check(CLI::PositiveNumber);
    command.footer(
        "Examples:\n"
        "  sweepcast watch                                    a live table of the gateway on this "
        "machine\n"
        "  sweepcast watch tcp://robot:8081 --csv --sweeps 10 > scan.csv\n"
        "  sweepcast watch 'ws://robot:8080/api/v1/stream?compression=none' --json"
    );
    command.callback([arguments, &exit_code] { exit_code = watch(*arguments); });
}

}  // namespace sweepcast::cli
