// Api: the routes under /api/v1 and their handlers. Value in, value out: no socket, no Beast.
#pragma once

#include "driver/device/diagnosis.hpp"
#include "driver/protocol/result.hpp"
#include "server/api/request.hpp"
#include "server/hub/local_hub.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace sweepcast::api {

/// What to change of a lidar; what is not set stays.
struct LidarUpdate {
    std::optional<std::string> mode;  ///< name or id
    std::optional<double> speed_hz;   ///< turns a second; 0: its usual speed
};

/// The lidar after a command.
struct Obeyed {
    hub::LidarSnapshotPtr lidar;
    /// True if the lidar cannot obey now, and will as soon as it can: its state says what it waits
    /// for.
    bool pending{};
};

/// What the API can have done to a lidar, by its number. May be called on any worker.
class LidarControl {
public:
    virtual ~LidarControl() = default;
    using Outcome = Result<Obeyed, Problem>;
    virtual boost::asio::awaitable<Outcome> start(std::uint32_t lidar, std::string mode) = 0;
    virtual boost::asio::awaitable<Outcome> stop(std::uint32_t lidar) = 0;
    virtual boost::asio::awaitable<Outcome> reset(std::uint32_t lidar) = 0;
    virtual boost::asio::awaitable<Outcome> update(std::uint32_t lidar, LidarUpdate update) = 0;
    /// What is wrong with it, if anything. Does not disturb a scan.
    virtual boost::asio::awaitable<Result<device::Diagnosis, Problem>> diagnose(std::uint32_t lidar
    ) = 0;
};

/// The API as seen from one worker: what it tells comes from that worker's share of the hub.
class Api {
public:
    Api(const hub::LocalHub& hub, LidarControl& control) : hub_(hub), control_(control) {}

    /// Answers any request, also impossible ones. Takes as long as the lidar takes to obey.
    boost::asio::awaitable<Response> handle(Request request) const;

private:
    /// Of a lidar that exists: 404 is answered for the others.
    using LidarHandler =
        boost::asio::awaitable<Response> (Api::*)(const Request&, hub::LidarSnapshotPtr) const;
    using Handler = boost::asio::awaitable<Response> (Api::*)() const;
    struct LidarRoute;
    struct Route;
    static const LidarRoute lidar_routes[];
    static const Route routes[];

    boost::asio::awaitable<Response>
    handle_lidar(const Request& request, std::string id, LidarHandler handler) const;

    boost::asio::awaitable<Response> list_lidars() const;
    boost::asio::awaitable<Response> healthz() const;
    boost::asio::awaitable<Response> dictionary() const;
    boost::asio::awaitable<Response> get_lidar(const Request&, hub::LidarSnapshotPtr) const;
    boost::asio::awaitable<Response> start(const Request&, hub::LidarSnapshotPtr) const;
    boost::asio::awaitable<Response> stop(const Request&, hub::LidarSnapshotPtr) const;
    boost::asio::awaitable<Response> reset(const Request&, hub::LidarSnapshotPtr) const;
    boost::asio::awaitable<Response> update(const Request&, hub::LidarSnapshotPtr) const;
    boost::asio::awaitable<Response> latest_scan(const Request&, hub::LidarSnapshotPtr) const;
    boost::asio::awaitable<Response> diagnosis(const Request&, hub::LidarSnapshotPtr) const;

    const hub::LocalHub& hub_;
    LidarControl& control_;
};

}  // namespace sweepcast::api
