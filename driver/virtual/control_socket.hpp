// ControlSocket: a Unix socket through which a virtual lidar that runs is told what to do.
#pragma once

#include "driver/async/task_group.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <sys/types.h>

namespace sweepcast::virtual_lidar {

/// Takes lines and answers each with a line. Open to this user only. The socket's file is removed
/// with this object, unless someone has put something else in its place.
class ControlSocket {
public:
    /// Connections at once; those beyond are told so, and closed.
    static constexpr std::size_t most_connections = 8;
    /// A connection on which nothing comes for so long is closed.
    static constexpr std::chrono::seconds idle_limit{60};
    /// Bytes of a line, without its end. A longer one is told so, and the connection closed.
    static constexpr std::size_t longest_line = 1024;

    /// What is answered to a line, both without the end of the line. Called on the executor.
    using Answer = std::function<std::string(std::string_view line)>;

    /// Makes the socket at `path`. One that a dead process has left there is replaced; nothing else
    /// is touched. Errors: errc::control_unavailable.
    static Result<std::unique_ptr<ControlSocket>, Problem>
    open(boost::asio::any_io_executor executor, std::string path, Answer answer);

    ControlSocket(const ControlSocket&) = delete;
    ControlSocket& operator=(const ControlSocket&) = delete;
    ~ControlSocket();

    /// Serves until cancelled, and then ends all connections.
    boost::asio::awaitable<void> run();

private:
    using Acceptor = boost::asio::local::stream_protocol::acceptor;
    using Socket = boost::asio::local::stream_protocol::socket;

    ControlSocket(
        boost::asio::any_io_executor executor,
        Acceptor acceptor,
        std::string path,
        ino_t inode,
        Answer answer
    );
    boost::asio::awaitable<void> serve(std::shared_ptr<Socket> socket);

    boost::asio::any_io_executor executor_;
    Acceptor acceptor_;
    std::string path_;
    ino_t inode_;  // of the file at path_
    Answer answer_;
    std::exception_ptr failure_;
};

/// Sends `line` to the control socket at `path` and gives the line that is answered. Blocks, at
/// most a few seconds. Errors: errc::control_unavailable.
[[nodiscard]] Result<std::string, Problem>
ask_control_socket(const std::string& path, std::string_view line);

}  // namespace sweepcast::virtual_lidar
