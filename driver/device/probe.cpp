#include "driver/device/probe.hpp"

#include "driver/device/advice.hpp"
#include "driver/device/conversation.hpp"
#include "driver/device/error.hpp"
#include "driver/device/find_baud.hpp"
#include "driver/device/motor.hpp"
#include "driver/link/open_link.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/reply.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;

namespace {

Problem
no_lidar(const error_code& failure, const link::LinkUrl& url, std::vector<std::uint32_t> bauds) {
    auto problem = advice(failure);
    if (problem.code == errc::no_answer) {
        const bool is_port = std::holds_alternative<link::SerialPlace>(url.where);
        problem.cause = fmt::format(
            "nothing that speaks as an RPLIDAR answers on {}{}",
            url.text,
            is_port ? fmt::format(" at {} baud", fmt::join(bauds, ", ")) : ""
        );
    }
    return problem;
}

}  // namespace

std::vector<std::uint32_t>
bauds_for(const link::LinkUrl& url, const std::vector<std::uint32_t>& hints) {
    const auto* port = std::get_if<link::SerialPlace>(&url.where);
    if (port != nullptr && port->baud) {
        return {*port->baud};
    }
    return bauds_to_try(hints);
}

asio::awaitable<Result<Probed, Problem>>
probe(asio::any_io_executor executor, link::LinkUrl url, std::vector<std::uint32_t> baud_hints) {
    const auto bauds = bauds_for(url, baud_hints);
    auto link = co_await link::open_link(executor, url, bauds.front());
    if (!link) {
        co_return link.error();
    }
    Conversation talk(**link);
    co_return co_await probe_open(talk, std::move(url), bauds);
}

asio::awaitable<Result<Probed, Problem>>
probe_open(Conversation& talk, link::LinkUrl url, std::vector<std::uint32_t> bauds) {
    const auto found = co_await find_baud(talk, bauds);
    if (!found) {
        co_return no_lidar(found.error(), url, bauds);
    }
    auto identity = co_await identify(talk);
    if (!identity) {
        co_return no_lidar(identity.error(), url, {found->baud});
    }
    (void)co_await stop_motor(talk, identity->motor.control);  // as nobody scans any more
    co_return Probed{std::move(*identity), found->baud};
}

asio::awaitable<std::vector<Discovered>> discover(
    asio::any_io_executor executor,
    std::vector<std::string> paths,
    BaudHints hints,
    std::shared_ptr<spdlog::logger> log
) {
    std::vector<Discovered> found;
    for (const auto& path : paths) {
        log->info("looking for a lidar on {}", path);
        // Named first: g++ 12 destroys such temporaries of a co_await twice.
        link::LinkUrl url{path, link::SerialPlace{path, {}}};
        auto port_hints = hints(path);
        const auto probed = co_await probe(executor, std::move(url), std::move(port_hints));
        if (probed) {
            log->info("{}: {} at {} baud", path, shown_name(probed->identity), probed->baud);
            found.push_back(
                {path, protocol::serial_text(probed->identity.info.serial), probed->baud}
            );
        } else {
            log->info("{}: {}", path, probed.error().cause);
        }
    }
    co_return found;
}

}  // namespace sweepcast::device
