#include "tests/e2e/gateway.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_future.hpp>

#include <algorithm>
#include <cstdlib>
#include <future>
#include <stdexcept>
#include <utility>

namespace sweepcast::test {

namespace asio = boost::asio;

namespace {

std::vector<std::string> command(std::string subcommand, std::vector<std::string> options) {
    std::vector<std::string> all{program(), std::move(subcommand)};
    all.insert(all.end(), options.begin(), options.end());
    return all;
}

std::vector<std::string> on_own_ports(std::vector<std::string> options) {
    for (const auto* port : {"--http", "--tcp"}) {
        if (std::ranges::find(options, port) == options.end()) {
            options.insert(options.end(), {port, "127.0.0.1:0"});
        }
    }
    return options;
}

/// What follows "://" in a line such as "page: http://127.0.0.1:4711/", without the slash at the
/// end.
std::string address_in(const std::string& line) {
    auto address = line.substr(line.find("://") + 3);
    if (address.ends_with('/')) {
        address.pop_back();
    }
    return address;
}

}  // namespace

std::string program() {
    return SWEEPCAST_BINARY;
}

ScratchDirectory::ScratchDirectory() {
    auto pattern = (std::filesystem::temp_directory_path() / "sweepcast-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) {
        throw std::runtime_error("no scratch directory");
    }
    path_ = pattern;
}

ScratchDirectory::~ScratchDirectory() {
    std::error_code ignored;  // a leftover in /tmp fails no test
    std::filesystem::remove_all(path_, ignored);
}

VirtualLidarProcess::VirtualLidarProcess(std::vector<std::string> options)
    : process(command("virtual", std::move(options)))
    , port(process.wait_for_output("")) {}

bool lost_nothing(const std::string& control) {
    Process asking({program(), "virtual", "--control", control, "--send", "status"});
    if (asking.wait() != 0) {
        throw std::runtime_error("the virtual lidar does not answer: " + asking.rest_of_log());
    }
    return asking.rest_of_output().find("unread_bytes=0\n") != std::string::npos;
}

GatewayProcess::GatewayProcess(std::vector<std::string> options)
    : process(command("serve", on_own_ports(std::move(options))))
    , http(address_in(process.wait_for_output("page: ")))
    , tcp(address_in(process.wait_for_output("tcp: "))) {}

std::vector<v1::Lidar> lidars_in(const v1::ServerMessage& message) {
    std::vector<v1::Lidar> lidars(message.hello().lidars().begin(), message.hello().lidars().end());
    if (message.has_lidar()) {
        lidars.push_back(message.lidar());
    }
    return lidars;
}

Subscriber::Subscriber(const std::string& url) {
    auto connected = run(client::StreamClient::connect(*client::parse_stream_url(url), patience));
    if (!connected) {
        throw std::runtime_error(connected.error().cause);
    }
    client_ = std::move(*connected);
}

Subscriber::~Subscriber() = default;

void Subscriber::subscribe(const std::string& lidar, bool compressed) {
    v1::Subscribe wish;
    wish.set_lidar(lidar);
    wish.set_compression(compressed ? v1::ZSTD : v1::NONE);
    subscribe(wish);
}

void Subscriber::subscribe(const v1::Subscribe& wish) {
    if (!run(client_->subscribe(wish))) {
        throw std::runtime_error("the connection has ended");
    }
}

v1::ServerMessage Subscriber::next() {
    const auto message = run(client_->receive());
    if (!message) {
        throw std::runtime_error("the connection has ended: " + message.error().message());
    }
    return **message;
}

v1::ServerMessage Subscriber::next(const std::function<bool(const v1::ServerMessage&)>& wanted) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
        auto message = next();
        if (wanted(message)) {
            return message;
        }
    }
    throw std::runtime_error("the message waited for did not come");
}

ReceivedSweep Subscriber::next_sweep() {
    const auto message = next([](const auto& received) { return received.has_frame(); });
    auto scan = decoder_.decode(message.frame());
    if (!scan) {
        throw std::runtime_error("a frame does not decode: " + scan.error().message());
    }
    return {message.frame().lidar(), message.frame().sequence(), std::move(*scan)};
}

v1::Lidar Subscriber::wait_for_lidar(const std::function<bool(const v1::Lidar&)>& wanted) {
    v1::Lidar found;
    next([&](const v1::ServerMessage& message) {
        const auto lidars = lidars_in(message);
        const auto fitting = std::ranges::find_if(lidars, wanted);
        if (fitting == lidars.end()) {
            return false;
        }
        found = *fitting;
        return true;
    });
    return found;
}

v1::Lidar Subscriber::wait_for_state(v1::Lidar::State state) {
    return wait_for_lidar([state](const auto& lidar) { return lidar.state() == state; });
}

std::string Subscriber::wait_for_end() {
    std::string reason;
    for (;;) {
        const auto message = run(client_->receive());
        if (!message) {
            return reason;
        }
        if ((*message)->has_closing()) {
            reason = (*message)->closing().reason();
        }
    }
}

template <class T>
T Subscriber::run(asio::awaitable<T> task) {
    auto done = asio::co_spawn(context_, std::move(task), asio::use_future);
    context_.restart();
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (done.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
        if (context_.run_one_until(deadline) == 0) {
            throw std::runtime_error("nothing came in time");
        }
    }
    return done.get();
}

HttpAnswer http(
    const std::string& address,
    const std::string& method,
    const std::string& target,
    const std::string& body
) {
    return HttpConnection(address).ask(method, target, body);
}

}  // namespace sweepcast::test
