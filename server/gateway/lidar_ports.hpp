// LidarPorts: at which serial port each lidar of the gateway is. Looks for one whose port is gone,
// or has another lidar now, at ports that newly appeared: there it is asked for its serial number.
// One that an earlier run knew is looked for at the ports that were there before, too. A place that
// is vacant is given to the first lidar that is nobody's.
#pragma once

#include "driver/async/notifier.hpp"
#include "driver/async/worker.hpp"
#include "driver/link/path_watch.hpp"
#include "server/gateway/lidar_memory.hpp"

#include <boost/asio/awaitable.hpp>
#include <spdlog/logger.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace sweepcast::gateway {

/// Safe from any thread; looks on a thread of its own, so that no lidar waits for it.
class LidarPorts {
public:
    /// How long another lidar on the port of one that is known is left alone, before it is taken in
    /// its place.
    static constexpr std::chrono::seconds adopt_after{3};

    /// Looks at USB ports that a lidar may be behind and at what matches `patterns`. Those that are
    /// there now are asked only for a lidar that was not met since (one that an earlier run knew,
    /// or any for a place that is vacant), and once: whoever is there has had the time to boot.
    LidarPorts(
        std::vector<std::string> patterns,
        const async::TaskGroup::OnFailure& on_failure,
        std::shared_ptr<spdlog::logger> log
    );
    ~LidarPorts();
    LidarPorts(const LidarPorts&) = delete;
    LidarPorts& operator=(const LidarPorts&) = delete;

    /// Ends the search. No on_move is called any more.
    void stop();

    /// Lidar `number` is expected at `path`: the one that is `remembered`, or whoever is there.
    /// `on_move` is called, on any thread, when it is elsewhere.
    void add(
        std::uint32_t number,
        const std::string& path,
        std::function<void()> on_move,
        std::optional<RememberedLidar> remembered = {}
    );

    /// Lidar `number` stands in for one, at `path`: its place is vacant. The first lidar that
    /// answers elsewhere and is nobody's takes it: then `on_move` is called, on any thread.
    void add_vacant(std::uint32_t number, const std::string& path, std::function<void()> on_move);

    /// Where it is, as far as is known.
    [[nodiscard]] std::string path_of(std::uint32_t number) const;

    /// The line speed at which it was found at path_of(); 0: it was not looked for.
    [[nodiscard]] std::uint32_t baud_at_path(std::uint32_t number) const;

    /// Nobody answers for the lidar now.
    void lost(std::uint32_t number);

    /// The port of lidar `number` is gone, or it was refused what is there: looks for it, if its
    /// serial number is known. It spoke at `baud`.
    void seek(std::uint32_t number, std::uint32_t baud);

    /// The lidar of that serial number answers at `path`, where lidar `number` was: is it that one?
    /// If it is another of the gateway's, that gets the port; if it is a stranger, it is taken only
    /// once the one that is known was not found elsewhere for `adopt_after`. What stands in at a
    /// place that is vacant is it.
    [[nodiscard]] bool
    is_it(std::uint32_t number, const std::string& path, const std::string& serial);

private:
    struct Lidar {
        std::string path;
        std::function<void()> on_move;
        std::string serial{};  ///< empty: not known yet
        std::uint32_t baud{};
        std::uint32_t baud_at_path{};
        bool vacant{};  ///< anybody's, until one that is not the stand-in is in hand
        bool met{};     ///< in this run
        bool in_hand{};
        bool sought{};
        /// Since when another one is at its port.
        std::optional<std::chrono::steady_clock::time_point> replaced{};
    };
    /// A port that was looked at: as what, and who answered, at which speed.
    struct Known {
        link::PathLook look;
        bool was_there{};  ///< from the start
        bool asked{};
        std::string serial{};
        std::uint32_t baud{};
    };

    Lidar* owner_of(const std::string& serial);
    Lidar* vacant_place();
    void take(Lidar& lidar, const std::string& serial);
    void move(Lidar& lidar, const std::string& path, std::uint32_t baud = 0);
    void fill(Lidar& vacant, const std::string& path, const Known& newcomer);
    [[nodiscard]] bool is_taken(const std::string& node) const;
    [[nodiscard]] bool any_sought() const;
    [[nodiscard]] bool any_sought_from_start() const;
    [[nodiscard]] std::vector<std::uint32_t> sought_bauds() const;
    void answered(const std::string& path, const Known& known);

    boost::asio::awaitable<void> search();
    boost::asio::awaitable<void> ask(std::string path, Known known);
    void look_around();

    std::vector<std::string> patterns_;
    std::shared_ptr<spdlog::logger> log_;
    mutable std::mutex mutex_;
    std::map<std::uint32_t, Lidar> lidars_;
    std::map<std::string, Known> known_;       ///< by device file; of the searching thread
    std::unique_ptr<async::Notifier> wanted_;  ///< on the worker, whose coroutines it outlives
    std::unique_ptr<async::Worker> worker_;
    bool stopped_{};
};

}  // namespace sweepcast::gateway
