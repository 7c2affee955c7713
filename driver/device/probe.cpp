#include "driver/device/probe.hpp"

#include "driver/device/advice.hpp"
#include "driver/device/conversation.hpp"
#include "driver/device/error.hpp"
#include "driver/link/port_list.hpp"
#include "driver/link/serial_link.hpp"
#include "driver/protocol/model.hpp"

#include <fmt/format.h>

#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;

asio::awaitable<Result<Identity, Problem>>
probe(asio::any_io_executor executor, std::string path, std::uint32_t baud) {
    auto link = link::open_serial(executor, path, baud);
    if (!link) {
        co_return link.error();
    }
    Conversation talk(**link);
    auto identity = co_await identify(talk);
    if (identity) {
        co_return std::move(*identity);
    }
    auto problem = advice(identity.error());
    if (problem.code == errc::no_answer) {
        problem.cause =
            fmt::format("nothing that speaks as an RPLIDAR answers on {} at {} baud", path, baud);
    }
    co_return problem;
}

asio::awaitable<std::vector<std::string>>
discover(asio::any_io_executor executor, std::shared_ptr<spdlog::logger> log) {
    std::vector<std::string> found;
    for (const auto& port : link::list_candidate_ports()) {
        log->info("looking for a lidar on {}", port.path);
        const auto identity = co_await probe(executor, port.path, default_baud);
        if (identity) {
            log->info("{}: {}", port.path, protocol::model_name(identity->info.model));
            found.push_back(port.path);
        } else {
            log->info("{}: {}", port.path, identity.error().cause);
        }
    }
    co_return found;
}

}  // namespace sweepcast::device
