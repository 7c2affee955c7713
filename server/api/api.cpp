#include "server/api/api.hpp"

#include "server/api/diagnosis_message.hpp"
#include "server/api/errors.hpp"
#include "server/api/json.hpp"
#include "server/api/scan_export.hpp"
#include "server/stream/lidar_message.hpp"
#include "server/version.hpp"
#include "sweepcast/v1/api.pb.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace sweepcast::api {

namespace asio = boost::asio;

struct Api::Route {
    const char* method;
    const char* before_id;
    const char* after_id;  ///< null: the path has no id
    Handler handler;
};

const Api::Route Api::routes[] = {
    {"GET", "/healthz", nullptr, &Api::healthz},
    {"GET", "/api/v1/lidars", nullptr, &Api::list_lidars},
    {"GET", "/api/v1/lidars/", "", &Api::get_lidar},
    {"GET", "/api/v1/lidars/", "/scan", &Api::latest_scan},
    {"GET", "/api/v1/lidars/", "/diagnosis", &Api::diagnosis},
    {"PATCH", "/api/v1/lidars/", "", &Api::update},
    {"POST", "/api/v1/lidars/", "/start", &Api::start},
    {"POST", "/api/v1/lidars/", "/stop", &Api::stop},
    {"POST", "/api/v1/lidars/", "/reset", &Api::reset},
};

namespace {

/// The id in `path` if it is before_id + id + after_id; an empty string for a path without one.
std::optional<std::string>
match(std::string_view path, const char* before_id, const char* after_id) {
    if (after_id == nullptr) {
        return path == before_id ? std::optional<std::string>("") : std::nullopt;
    }
    const std::string_view before = before_id;
    const std::string_view after = after_id;
    if (path.size() <= before.size() + after.size() || !path.starts_with(before) ||
        !path.ends_with(after)) {
        return std::nullopt;
    }
    const auto id = path.substr(before.size(), path.size() - before.size() - after.size());
    return id.find('/') == std::string_view::npos ? std::optional<std::string>(id) : std::nullopt;
}

Response lidar_response(const hub::LidarSnapshot& lidar) {
    v1::Lidar message;
    stream::to_message(lidar, message);
    return {200, "application/json", to_json(message), {}};
}

Response lidar_not_found(const std::string& id) {
    return error_response(
        404,
        "lidar_not_found",
        fmt::format("there is no lidar \"{}\"", id),
        "GET /api/v1/lidars lists them"
    );
}

Response outcome_response(const LidarControl::Outcome& outcome) {
    return outcome ? lidar_response(**outcome) : error_response(outcome.error());
}

bool wants_csv(const Request& request) {
    const auto format = request.parameter("format");
    return format == "csv" ||
           (format.empty() && request.accept.find("text/csv") != std::string::npos);
}

}  // namespace

asio::awaitable<Response> Api::handle(Request request) const {
    const auto method = request.method == "HEAD" ? "GET" : request.method;
    std::string allowed;
    for (const auto& route : routes) {
        const auto id = match(request.path, route.before_id, route.after_id);
        if (!id) {
            continue;
        }
        if (method == route.method) {
            co_return co_await (this->*route.handler)(request, *id);
        }
        const std::string_view also = route.method;
        allowed += allowed.empty() ? "" : ", ";
        allowed += also == "GET" ? "GET, HEAD" : also;
    }
    if (!allowed.empty()) {
        co_return method_not_allowed(request, allowed);
    }
    co_return error_response(
        404,
        "not_found",
        fmt::format("there is nothing at {}", request.path),
        "the API begins at /api/v1/lidars, the page is at /"
    );
}

asio::awaitable<Response> Api::list_lidars(const Request&, const std::string&) const {
    v1::ListLidarsResponse message;
    for (const auto& lidar : hub_.lidars()) {
        if (lidar) {
            stream::to_message(*lidar, *message.add_lidars());
        }
    }
    co_return Response{200, "application/json", to_json(message), {}};
}

asio::awaitable<Response> Api::get_lidar(const Request&, const std::string& id) const {
    const auto lidar = hub_.find(id);
    co_return lidar ? lidar_response(*lidar) : lidar_not_found(id);
}

asio::awaitable<Response> Api::start(const Request& request, const std::string& id) const {
    const auto lidar = hub_.find(id);
    if (!lidar) {
        co_return lidar_not_found(id);
    }
    v1::StartRequest message;
    if (const auto parsed = from_json(request.body, message); !parsed) {
        co_return error_response(
            400,
            "bad_body",
            "the body is not a start request: " + parsed.error(),
            R"(send nothing, or JSON such as {"mode": "Express"})"
        );
    }
    co_return outcome_response(co_await control_.start(lidar->number, message.mode()));
}

asio::awaitable<Response> Api::stop(const Request&, const std::string& id) const {
    const auto lidar = hub_.find(id);
    if (!lidar) {
        co_return lidar_not_found(id);
    }
    co_return outcome_response(co_await control_.stop(lidar->number));
}

asio::awaitable<Response> Api::reset(const Request&, const std::string& id) const {
    const auto lidar = hub_.find(id);
    if (!lidar) {
        co_return lidar_not_found(id);
    }
    co_return outcome_response(co_await control_.reset(lidar->number));
}

asio::awaitable<Response> Api::update(const Request& request, const std::string& id) const {
    const auto lidar = hub_.find(id);
    if (!lidar) {
        co_return lidar_not_found(id);
    }
    v1::UpdateRequest message;
    if (const auto parsed = from_json(request.body, message); !parsed) {
        co_return error_response(
            400,
            "bad_body",
            "the body is not an update: " + parsed.error(),
            R"(send JSON such as {"speed_hz": 7} or {"mode": "Express"})"
        );
    }
    if (!message.has_mode() && !message.has_speed_hz()) {
        co_return error_response(
            400,
            "bad_body",
            "the update changes nothing",
            R"(send JSON such as {"speed_hz": 7} or {"mode": "Express"})"
        );
    }
    LidarUpdate update;
    if (message.has_mode()) {
        update.mode = message.mode();
    }
    if (message.has_speed_hz()) {
        update.speed_hz = message.speed_hz();
    }
    co_return outcome_response(co_await control_.update(lidar->number, std::move(update)));
}

asio::awaitable<Response> Api::latest_scan(const Request& request, const std::string& id) const {
    const auto lidar = hub_.find(id);
    if (!lidar) {
        co_return lidar_not_found(id);
    }
    const auto format = request.parameter("format");
    if (!format.empty() && format != "json" && format != "csv") {
        co_return error_response(
            400,
            "unknown_format",
            fmt::format("no format \"{}\"", format),
            "formats: json, csv"
        );
    }
    const auto sweep = hub_.latest_sweep(lidar->number);
    if (!sweep) {
        co_return error_response(
            404,
            "no_scan_yet",
            fmt::format("lidar \"{}\" has not completed a sweep yet", id),
            fmt::format("start it: POST /api/v1/lidars/{}/start", id)
        );
    }
    if (wants_csv(request)) {
        co_return Response{200, "text/csv; charset=utf-8", to_csv(*sweep), {}};
    }
    v1::LatestScan message;
    to_message(*sweep, message);
    co_return Response{200, "application/json", to_json(message), {}};
}

asio::awaitable<Response> Api::diagnosis(const Request&, const std::string& id) const {
    const auto lidar = hub_.find(id);
    if (!lidar) {
        co_return lidar_not_found(id);
    }
    const auto diagnosis = co_await control_.diagnose(lidar->number);
    if (!diagnosis) {
        co_return error_response(diagnosis.error());
    }
    v1::Diagnosis message;
    to_message(*diagnosis, message);
    co_return Response{200, "application/json", to_json(message), {}};
}

asio::awaitable<Response> Api::healthz(const Request&, const std::string&) const {
    v1::HealthzResponse message;
    message.set_status("ok");
    message.set_version(version);
    const auto& lidars = hub_.lidars();
    message.set_lidars(static_cast<std::uint32_t>(lidars.size()));
    message.set_scanning(static_cast<std::uint32_t>(std::ranges::count_if(
        lidars,
        [](const auto& lidar) { return lidar && lidar->state.phase == device::Phase::scanning; }
    )));
    message.set_subscribers(hub_.subscribers());
    co_return Response{200, "application/json", to_json(message), {}};
}

}  // namespace sweepcast::api
