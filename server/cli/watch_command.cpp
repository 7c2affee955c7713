// `sweepcast watch`: subscribes to a gateway and prints what comes. The stream's reference client.
#include "server/cli/command.hpp"
#include "server/cli/stop_signals.hpp"
#include "server/cli/watch_output.hpp"
#include "server/cli/wish_options.hpp"
#include "server/client/client.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/core.h>

#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace sweepcast::cli {

namespace asio = boost::asio;

namespace {

struct WatchArguments {
    std::string url{"tcp://127.0.0.1:8081"};
    v1::Subscribe wish;
    std::optional<std::string> wish_option;  ///< one that was given
    bool csv{};
    bool json{};
    bool reconnect{true};
    std::uint64_t sweeps{std::numeric_limits<std::uint64_t>::max()};
};

std::unique_ptr<WatchOutput> make_output(const WatchArguments& arguments) {
    if (arguments.csv) {
        return make_csv_output(arguments.wish.kind() == v1::SECTOR);
    }
    return arguments.json ? make_json_output() : make_table_output();
}

/// Takes in what comes of a gateway.
class Watcher {
public:
    explicit Watcher(const WatchArguments& arguments)
        : output_(make_output(arguments))
        , sweeps_left_(arguments.sweeps) {}

    /// False once there is nothing more to wait for.
    bool take(const client::Event& event) {
        const bool goes_on = std::visit([this](const auto& what) { return take_in(what); }, event);
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
    bool take_in(const client::Connected& connected) {
        output_->on_connected(connected);
        return true;
    }

    bool take_in(const client::Disconnected& disconnected) {
        output_->on_disconnected(disconnected);
        return true;
    }

    bool take_in(const v1::Lidar& lidar) {
        output_->on_lidar(lidar);
        return true;
    }

    bool take_in(const client::Scan& scan) {
        obeyed_ = true;
        output_->on_scan(scan);
        const bool is_whole = scan.kind == v1::SWEEP || scan.last;
        return !is_whole || --sweeps_left_ > 0;
    }

    bool take_in(const v1::Subscribed&) {
        obeyed_ = true;
        return true;
    }

    bool take_in(const client::LeftOut& left_out) {
        output_->on_left_out(left_out);
        return true;
    }

    bool take_in(const v1::StreamStats& stats) {
        output_->on_stats(stats);
        return true;
    }

    /// What was obeyed once is refused for a while only: a gateway that was started anew knows its
    /// lidars when it has heard of them.
    bool take_in(const v1::StreamError& refusal) {
        if (obeyed_ && refusal.code() == "lidar_not_found") {
            output_->on_refusal(refusal);
            return true;
        }
        return fail({{}, refusal.message(), refusal.hint()});
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
    std::uint64_t sweeps_left_;
    bool obeyed_{};
    int exit_code_{};
};

client::ClientOptions options_for(const client::StreamUrl& url, const WatchArguments& arguments) {
    client::ClientOptions options;
    options.wish = arguments.wish;
    if (url.has_query()) {
        options.wish.reset();
    }
    options.reconnect =
        arguments.reconnect ? client::Reconnect::once_connected : client::Reconnect::never;
    return options;
}

asio::awaitable<void>
receive_all(client::StreamUrl url, const WatchArguments& arguments, Watcher& watcher) {
    auto options = options_for(url, arguments);
    client::Client client(co_await asio::this_coro::executor, std::move(url), std::move(options));
    for (;;) {
        const auto event = co_await client.next();
        if (!event) {
            watcher.fail(event.error());
            co_return;
        }
        if (!watcher.take(*event)) {
            co_return;
        }
    }
}

int watch(const WatchArguments& arguments) {
    auto url = client::parse_stream_url(arguments.url);
    if (!url) {
        return report_misuse(url.error());
    }
    if (url->has_query() && arguments.wish_option) {
        return report_misuse(
            {{},
             fmt::format("what to get is in the URL and in {}", *arguments.wish_option),
             "say it in one place: options alone, without the URL's query, can say it all"}
        );
    }
    ignore_write_signals();
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
    auto* csv = command.add_flag("--csv", arguments->csv, "Print a line a sample");
    command.add_flag("--json", arguments->json, "Print a line of JSON a sweep (or sector)")
        ->excludes(csv);
    command.add_option("--sweeps", arguments->sweeps, "End after so many sweeps")
        ->check(CLI::PositiveNumber);
    command.add_flag(
        "--reconnect,!--no-reconnect",
        arguments->reconnect,
        "Go on when the gateway comes back (the usual), or end with an error when it goes"
    );
    add_wish_options(command, arguments->wish);
    command.footer(
        "Examples:\n"
        "  sweepcast watch                                    a live table of the gateway on this "
        "machine\n"
        "  sweepcast watch tcp://robot:8081 --csv --sweeps 10 > scan.csv\n"
        "  sweepcast watch tcp://robot:8081 --json --keep 300-60 --max-distance 4000 --max-rate 2\n"
        "  sweepcast watch tcp://robot:8081 --csv --kind sector --sector-deg 30\n"
        "  sweepcast watch tcp://robot:8081 --csv --bins 360 --bins-minimum\n"
        "  sweepcast watch 'ws://robot:8080/api/v1/stream?compression=none' --json"
    );
    command.callback([arguments, &command, &exit_code] {
        arguments->wish_option = given_wish_option(command);
        exit_code = watch(*arguments);
    });
}

}  // namespace sweepcast::cli
