// The real program for end-to-end tests: a virtual lidar, a gateway, and what clients see of it.
#pragma once

#include "server/client/stream_client.hpp"
#include "server/frame/frame_decoder.hpp"
#include "tests/support/process.hpp"

#include <boost/asio/io_context.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::test {

/// A directory of the test's own, removed with it.
class ScratchDirectory {
public:
    ScratchDirectory();
    ~ScratchDirectory();
    ScratchDirectory(const ScratchDirectory&) = delete;
    ScratchDirectory& operator=(const ScratchDirectory&) = delete;
    [[nodiscard]] std::string file(const std::string& name) const {
        return (path_ / name).string();
    }

private:
    std::filesystem::path path_;
};

/// `sweepcast virtual` with these options.
struct VirtualLidarProcess {
    explicit VirtualLidarProcess(std::vector<std::string> options = {});
    Process process;
    std::string port;  ///< what to open: a path or a URL
};

/// Whether the virtual lidar that is controlled at this path has lost no byte because its host did
/// not read in time. Virtual lidars drop what is not read, as real ones do. On a busy machine that
/// happens, and what a test sees of such a run shows nothing.
[[nodiscard]] bool lost_nothing(const std::string& control);
/// So often a test repeats a run in which bytes were lost.
inline constexpr int most_runs = 20;

/// `sweepcast serve` with these options, on ports of its own where they say none.
struct GatewayProcess {
    explicit GatewayProcess(std::vector<std::string> options);
    Process process;
    std::string http;  ///< "127.0.0.1:PORT"
    std::string tcp;   ///< "127.0.0.1:PORT"
};

/// The path of the program under test.
[[nodiscard]] std::string program();

/// One frame as a client has it.
struct ReceivedSweep {
    std::string lidar;
    std::uint64_t sequence{};
    frame::DecodedScan scan;
};

/// The lidars whose states a message brings: all in a Hello, one in a state message, else none.
[[nodiscard]] std::vector<v1::Lidar> lidars_in(const v1::ServerMessage& message);

/// A subscriber that blocks. Every call throws if nothing comes in time.
class Subscriber {
public:
    /// Connects to "tcp://..." or "ws://...".
    explicit Subscriber(const std::string& url);
    ~Subscriber();

    void subscribe(const std::string& lidar = "", bool compressed = true);
    void subscribe(const v1::Subscribe& wish);

    /// The next message of any kind.
    v1::ServerMessage next();
    /// The next message for which `wanted` holds; others are passed over.
    v1::ServerMessage next(const std::function<bool(const v1::ServerMessage&)>& wanted);
    /// The next sweep; other messages are passed over.
    ReceivedSweep next_sweep();
    /// Waits for a message with a lidar's state for which `wanted` holds; returns that state.
    v1::Lidar wait_for_lidar(const std::function<bool(const v1::Lidar&)>& wanted);
    /// Waits until a lidar is in this state.
    v1::Lidar wait_for_state(v1::Lidar::State state);
    /// Reads until the connection ends; returns the reason given, if any.
    std::string wait_for_end();

private:
    template <class T>
    T run(boost::asio::awaitable<T> task);

    boost::asio::io_context context_;
    std::unique_ptr<client::StreamClient> client_;
    frame::FrameDecoder decoder_;
};

/// An answer of the HTTP API.
struct HttpAnswer {
    int status{};
    std::vector<std::pair<std::string, std::string>> headers;  ///< names in lower case
    std::string body;
    [[nodiscard]] std::string header(const std::string& name) const;
};

/// A connection that stays open between requests, as a browser's does.
class HttpConnection {
public:
    explicit HttpConnection(const std::string& address);
    ~HttpConnection();

    HttpAnswer ask(
        const std::string& method,
        const std::string& target,
        const std::string& body = "",
        const std::vector<std::pair<std::string, std::string>>& headers = {}
    );
    /// Sends these bytes as they are and reads one answer.
    HttpAnswer send_raw(const std::string& bytes);

private:
    struct Socket;
    std::unique_ptr<Socket> socket_;
};

/// One request on a connection of its own.
HttpAnswer http(
    const std::string& address,
    const std::string& method,
    const std::string& target,
    const std::string& body = ""
);

}  // namespace sweepcast::test
