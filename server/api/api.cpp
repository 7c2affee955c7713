#include "server/api/api.hpp"

#include "server/api/diagnosis_message.hpp"
#include "server/api/errors.hpp"
#include "server/api/json.hpp"
#include "server/api/scan_export.hpp"
#include "server/frame/dictionary.hpp"
#include "server/stream/lidar_message.hpp"
#include "server/version.hpp"
#include "sweepcast/v1/api.pb.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string_view>
#include <utility>

namespace sweepcast::api {

namespace asio = boost::asio;

struct Api::Route {
    std::string_view method;
    std::string_view path;
    Handler handler;
};

struct Api::LidarRoute {
    std::string_view method;
    std::string_view after_id;
    LidarHandler handler;
    /// The only query parameter that the route takes; empty: it takes none.
    std::string_view parameter{};
};

namespace {

/// The path of the one dictionary there is.
const std::string& dictionary_path() {
    static const auto path = fmt::format("/api/v1/dictionaries/{}", frame::dictionary_id());
    return path;
}

}  // namespace

const Api::Route Api::routes[] = {
    {"GET", "/healthz", &Api::healthz},
    {"GET", dictionary_path(), &Api::dictionary},
    {"GET", "/api/v1/lidars", &Api::list_lidars},
};

/// Below /api/v1/lidars/ID.
const Api::LidarRoute Api::lidar_routes[] = {
    {"GET", "", &Api::get_lidar},
    {"GET", "/scan", &Api::latest_scan, "format"},
    {"GET", "/diagnosis", &Api::diagnosis},
    {"PATCH", "", &Api::update},
    {"POST", "/start", &Api::start},
    {"POST", "/stop", &Api::stop},
    {"POST", "/reset", &Api::reset},
};

namespace {

/// What a path below a lidar's name means.
struct LidarPath {
    std::string id;
    std::string after_id;  ///< with its slash; empty for the lidar itself
};

std::optional<LidarPath> parse_lidar_path(std::string_view path) {
    constexpr std::string_view before_id = "/api/v1/lidars/";
    if (!path.starts_with(before_id)) {
        return std::nullopt;
    }
    path.remove_prefix(before_id.size());
    const auto id = path.substr(0, path.find('/'));
    if (id.empty()) {
        return std::nullopt;
    }
    return LidarPath{std::string(id), std::string(path.substr(id.size()))};
}

/// The methods that a path knows, as the header Allow lists them.
class Allowed {
public:
    void add(std::string_view method) {
        text_ += text_.empty() ? "" : ", ";
        text_ += method == "GET" ? "GET, HEAD" : method;
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_;
};

/// Refuses query parameters other than `known`, the only one that a route takes (empty: none).
std::optional<Response> refuse_parameters(const Request& request, std::string_view known = {}) {
    for (const auto& [name, value] : request.query) {
        if (name != known) {
            return error_response(
                400,
                "unknown_parameter",
                fmt::format("no parameter \"{}\"", name),
                known.empty() ? "this request takes no query parameters"
                              : fmt::format("parameters: {}", known)
            );
        }
    }
    if (request.query.size() > 1) {
        return error_response(
            400,
            "repeated_parameter",
            fmt::format("the parameter \"{}\" is given twice", known),
            "give it once"
        );
    }
    return std::nullopt;
}

Response lidar_response(const hub::LidarSnapshot& lidar, int status = 200) {
    v1::Lidar message;
    stream::to_message(lidar, message);
    return {status, "application/json", to_json(message), {}};
}

Response outcome_response(const LidarControl::Outcome& outcome) {
    if (!outcome) {
        return error_response(outcome.error());
    }
    return lidar_response(*outcome->lidar, outcome->pending ? 202 : 200);
}

bool wants_csv(const Request& request) {
    const auto format = request.parameter("format");
    return format == "csv" ||
           (format.empty() && request.accept.find("text/csv") != std::string::npos);
}

}  // namespace

asio::awaitable<Response> Api::handle(Request request) const {
    const std::string method = request.method == "HEAD" ? "GET" : request.method;
    Allowed allowed;
    for (const auto& route : routes) {
        if (request.path != route.path) {
            continue;
        }
        if (method == route.method) {
            if (auto refusal = refuse_parameters(request)) {
                co_return std::move(*refusal);
            }
            co_return co_await (this->*route.handler)();
        }
        allowed.add(route.method);
    }
    const auto path = parse_lidar_path(request.path);
    for (const auto& route : lidar_routes) {
        if (!path || path->after_id != route.after_id) {
            continue;
        }
        if (method == route.method) {
            if (auto refusal = refuse_parameters(request, route.parameter)) {
                co_return std::move(*refusal);
            }
            co_return co_await handle_lidar(request, path->id, route.handler);
        }
        allowed.add(route.method);
    }
    if (!allowed.text().empty()) {
        co_return method_not_allowed(request, allowed.text());
    }
    co_return error_response(
        404,
        "not_found",
        fmt::format("there is nothing at {}", request.path),
        "the API begins at /api/v1/lidars, the page is at /"
    );
}

asio::awaitable<Response>
Api::handle_lidar(const Request& request, std::string id, LidarHandler handler) const {
    const auto lidar = hub_.find(id);
    if (!lidar) {
        co_return error_response(
            404,
            "lidar_not_found",
            fmt::format("there is no lidar \"{}\"", id),
            "GET /api/v1/lidars lists them"
        );
    }
    co_return co_await (this->*handler)(request, lidar);
}

asio::awaitable<Response> Api::list_lidars() const {
    v1::ListLidarsResponse message;
    for (const auto& lidar : hub_.lidars()) {
        if (lidar) {
            stream::to_message(*lidar, *message.add_lidars());
        }
    }
    co_return Response{200, "application/json", to_json(message), {}};
}

asio::awaitable<Response> Api::get_lidar(const Request&, hub::LidarSnapshotPtr lidar) const {
    co_return lidar_response(*lidar);
}

asio::awaitable<Response> Api::start(const Request& request, hub::LidarSnapshotPtr lidar) const {
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

asio::awaitable<Response> Api::stop(const Request&, hub::LidarSnapshotPtr lidar) const {
    co_return outcome_response(co_await control_.stop(lidar->number));
}

asio::awaitable<Response> Api::reset(const Request&, hub::LidarSnapshotPtr lidar) const {
    co_return outcome_response(co_await control_.reset(lidar->number));
}

asio::awaitable<Response> Api::update(const Request& request, hub::LidarSnapshotPtr lidar) const {
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

asio::awaitable<Response> Api::latest_scan(const Request& request, hub::LidarSnapshotPtr lidar)
    const {
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
            fmt::format("lidar \"{}\" has not completed a sweep yet", lidar->id),
            fmt::format("start it: POST /api/v1/lidars/{}/start", lidar->id)
        );
    }
    v1::Lidar state;
    stream::to_message(*lidar, state);
    const auto age = age_ms(*sweep, std::chrono::steady_clock::now());
    if (wants_csv(request)) {
        co_return Response{
            200,
            "text/csv; charset=utf-8",
            to_csv(*sweep),
            {{"Lidar-State", v1::Lidar::State_Name(state.state())},
             {"Sweep-Age-Ms", std::to_string(age)}}};
    }
    v1::LatestScan message;
    to_message(*sweep, message);
    message.set_state(state.state());
    message.set_age_ms(age);
    co_return Response{200, "application/json", to_json(message), {}};
}

asio::awaitable<Response> Api::diagnosis(const Request&, hub::LidarSnapshotPtr lidar) const {
    const auto diagnosis = co_await control_.diagnose(lidar->number);
    if (!diagnosis) {
        co_return error_response(diagnosis.error());
    }
    v1::Diagnosis message;
    to_message(*diagnosis, message);
    co_return Response{200, "application/json", to_json(message), {}};
}

asio::awaitable<Response> Api::dictionary() const {
    const auto bytes = frame::dictionary_bytes();
    co_return Response{200, "application/zstd-dictionary", {bytes.begin(), bytes.end()}, {}};
}

asio::awaitable<Response> Api::healthz() const {
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
