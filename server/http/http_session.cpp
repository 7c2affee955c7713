#include "server/http/http_session.hpp"

#include "driver/async/task_group.hpp"
#include "server/api/errors.hpp"
#include "server/api/request.hpp"
#include "server/http/page.hpp"
#include "server/stream/messages.hpp"
#include "server/stream/session.hpp"
#include "server/stream/ws_transport.hpp"
#include "server/version.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace sweepcast::http {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = beast::http;
using namespace std::chrono_literals;

namespace {

constexpr std::uint32_t header_limit = 16U * 1024;
constexpr std::uint64_t body_limit = 64ULL * 1024;
constexpr auto first_request_limit = 30s;
constexpr auto next_request_limit = 60s;  // the wait for it included
constexpr auto response_limit = 30s;
constexpr auto linger_limit = 1s;
constexpr std::size_t linger_bytes = 256UL * 1024;

constexpr const char* stream_path = "/api/v1/stream";

using BeastRequest = bhttp::request<bhttp::string_body>;
using BeastResponse = bhttp::response<bhttp::string_body>;

std::string_view view(beast::string_view text) {
    return {text.data(), text.size()};
}

BeastResponse
to_beast(api::Response response, unsigned http_version, bool keep_alive, bool head_only) {
    BeastResponse out(static_cast<bhttp::status>(response.status), http_version);
    out.set(bhttp::field::server, std::string("sweepcast ") + version);
    out.set("X-Content-Type-Options", "nosniff");
    out.set(bhttp::field::content_type, response.content_type);
    for (const auto& [name, value] : response.headers) {
        out.set(name, value);
    }
    if (out.count(bhttp::field::cache_control) == 0) {
        out.set(bhttp::field::cache_control, "no-store");
    }
    out.keep_alive(keep_alive);
    const auto size = response.body.size();
    if (!head_only) {
        out.body() = std::move(response.body);
    }
    if (response.status != 304) {
        out.content_length(size);
    }
    return out;
}

/// The answer to a request that could not even be read; nothing where none is due.
std::optional<api::Response> unreadable(const error_code& failed) {
    if (failed == bhttp::error::header_limit) {
        return api::error_response(
            431,
            "header_too_large",
            "the header is too large",
            fmt::format("at most {} bytes", header_limit)
        );
    }
    if (failed == bhttp::error::body_limit) {
        return api::error_response(
            413,
            "body_too_large",
            "the body is too large",
            fmt::format("at most {} bytes", body_limit)
        );
    }
    if (failed.category() == bhttp::make_error_code(bhttp::error::bad_method).category() &&
        failed != bhttp::error::end_of_stream && failed != bhttp::error::partial_message) {
        return api::error_response(
            400,
            "bad_request",
            "this is not an HTTP request: " + failed.message(),
            "the stream for programs is on the TCP port"
        );
    }
    return std::nullopt;
}

api::Response wrong_origin() {
    return api::error_response(
        403,
        "wrong_origin",
        "a page of another site may not use this gateway",
        "open the gateway's own page, or send no Origin header"
    );
}

/// Returns the refusal of a request to a host that is not this gateway, if it is one.
std::optional<api::Response> wrong_host(const BeastRequest& request, const HostNames& hosts) {
    const auto given = request.count(bhttp::field::host);
    if (given == 0 && request.version() < 11) {
        return std::nullopt;  // HTTP/1.0 has no such header, and browsers do not speak it
    }
    const auto host = view(request[bhttp::field::host]);
    const auto check = given == 1 ? hosts.check(host) : HostCheck::malformed;
    if (check == HostCheck::malformed) {
        return api::error_response(
            400,
            "bad_host",
            given == 0   ? "the request has no Host header"
            : given == 1 ? fmt::format("the Host header \"{}\" is no host name or address", host)
                         : "the request has several Host headers",
            "send one Host header, such as \"Host: 127.0.0.1:8080\""
        );
    }
    if (check == HostCheck::other) {
        return api::error_response(
            421,
            "unknown_host",
            fmt::format("this gateway does not answer to the host name \"{}\"", host),
            "use the IP address of the gateway's machine or its host name; if it has other names, "
            "start the gateway with --host-name NAME"
        );
    }
    return std::nullopt;
}

bool from_own_page(const BeastRequest& request) {
    return api::same_origin(view(request[bhttp::field::origin]), view(request[bhttp::field::host]));
}

/// A connection that is to become a stream.
struct Upgrade {
    asio::ip::tcp::socket socket;
    BeastRequest request;
    std::string unread;  ///< what the client sent after the request
    stream::SessionSettings settings;
};

/// One connection, with the deadlines of its socket.
class Session {
public:
    Session(asio::ip::tcp::socket socket, HttpContext context)
        : stream_(std::move(socket))
        , context_(std::move(context)) {}

    /// Answers requests to the connection's end, or until it is to become a stream.
    asio::awaitable<std::unique_ptr<Upgrade>> run() {
        bool keep_alive = true;
        for (auto limit = std::chrono::seconds(first_request_limit); keep_alive;
             limit = next_request_limit) {
            bhttp::request_parser<bhttp::string_body> parser;
            parser.header_limit(header_limit);
            parser.body_limit(body_limit);
            stream_.expires_after(limit);
            const auto [failed, size] = co_await bhttp::async_read(
                stream_,
                buffer_,
                parser,
                asio::as_tuple(asio::use_awaitable)
            );
            if (failed) {
                if (auto problem = unreadable(failed)) {
                    auto response = to_beast(std::move(*problem), 11, false, false);
                    co_await write(std::move(response));
                }
                break;
            }
            auto request = parser.release();
            if (beast::websocket::is_upgrade(request)) {
                auto settings = settings_or_error(request);
                if (settings) {
                    auto socket = stream_.release_socket();
                    co_return std::make_unique<Upgrade>(Upgrade{
                        std::move(socket),
                        std::move(request),
                        beast::buffers_to_string(buffer_.cdata()),
                        std::move(*settings)});
                }
                auto refusal = to_beast(settings.error(), request.version(), false, false);
                co_await write(std::move(refusal));
                break;
            }
            // A command takes as long as the lidar takes to obey, which the device bounds.
            stream_.expires_never();
            auto response = co_await answer(request);
            const bool written = co_await write(std::move(response));
            keep_alive = written && request.keep_alive();
        }
        co_await linger();
        co_return nullptr;
    }

private:
    /// Ends the connection such that the last response arrives: closing while bytes of the client
    /// are unread would reset it, and the client could lose what it has not read yet.
    asio::awaitable<void> linger() {
        error_code ignored;  // the client may have gone first
        stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
        stream_.expires_after(linger_limit);
        std::array<std::uint8_t, 16UL * 1024> unwanted{};
        const auto space = asio::buffer(unwanted);
        for (std::size_t discarded = 0; discarded < linger_bytes;) {
            const auto [ended, size] =
                co_await stream_.async_read_some(space, asio::as_tuple(asio::use_awaitable));
            if (ended) {
                co_return;
            }
            discarded += size;
        }
    }

    /// The answer where a handler broke down; the log has the cause.
    api::Response internal_error(const BeastRequest& request, const std::exception& failure) {
        context_.log->error(
            "http: {} {} failed: {}",
            view(request.method_string()),
            view(request.target()),
            failure.what()
        );
        return api::error_response(
            500,
            "internal_error",
            "the gateway could not answer",
            "its log says why"
        );
    }

    asio::awaitable<BeastResponse> answer(const BeastRequest& request) {
        const bool head = request.method() == bhttp::verb::head;
        api::Response response;
        try {
            response = co_await route(request);
        } catch (const std::exception& failure) {
            if (async::is_cancellation(std::current_exception())) {
                throw;  // the gateway is ending
            }
            response = internal_error(request, failure);
        }
        co_return to_beast(std::move(response), request.version(), request.keep_alive(), head);
    }

    asio::awaitable<api::Response> route(const BeastRequest& from) {
        if (auto refusal = wrong_host(from, context_.hosts)) {
            co_return std::move(*refusal);
        }
        api::Request request;
        request.method = from.method_string();
        request.accept = from[bhttp::field::accept];
        request.body = from.body();
        if (!api::set_target(request, view(from.target()))) {
            co_return api::error_response(
                400,
                "bad_target",
                fmt::format("\"{}\" is not a path", view(from.target())),
                ""
            );
        }
        const bool looks = request.method == "GET" || request.method == "HEAD";
        if (!looks && !from_own_page(from)) {
            co_return wrong_origin();
        }
        if (looks && request.path == stream_path) {
            co_return api::error_response(
                426,
                "upgrade_required",
                "the stream speaks WebSocket",
                fmt::format("open it as ws://HOST:PORT{}", stream_path)
            );
        }
        auto file = page_response(
            request.path,
            view(from[bhttp::field::accept_encoding]),
            view(from[bhttp::field::if_none_match])
        );
        if (!looks && (file || request.path == stream_path)) {
            co_return api::method_not_allowed(request, "GET, HEAD");
        }
        if (file) {
            co_return std::move(*file);
        }
        co_return co_await context_.api.handle(std::move(request));
    }

    Result<stream::SessionSettings, api::Response> settings_or_error(const BeastRequest& from) {
        try {
            return session_settings(from);
        } catch (const std::exception& failure) {
            return internal_error(from, failure);
        }
    }

    Result<stream::SessionSettings, api::Response> session_settings(const BeastRequest& from) {
        if (auto refusal = wrong_host(from, context_.hosts)) {
            return std::move(*refusal);
        }
        api::Request request;
        if (!api::set_target(request, view(from.target())) || request.path != stream_path) {
            return api::error_response(
                404,
                "not_found",
                fmt::format("there is no stream at {}", view(from.target())),
                fmt::format("it is at {}", stream_path)
            );
        }
        if (!from_own_page(from)) {
            return wrong_origin();
        }
        stream::SessionSettings settings;
        error_code gone;
        const auto peer = stream_.socket().remote_endpoint(gone);
        settings.client = fmt::format("ws {}:{}", peer.address().to_string(), peer.port());
        settings.mailbox = context_.mailbox;
        if (!request.query.empty()) {
            auto order = stream::order_from_query(request.query, context_.hub);
            if (!order) {
                const auto& refusal = order.error();
                const int status = refusal.code == "lidar_not_found" ? 404 : 400;
                return api::error_response(status, refusal.code, refusal.message, refusal.hint);
            }
            settings.order = std::move(*order);
        }
        return settings;
    }

    /// False if the client could not take it.
    asio::awaitable<bool> write(BeastResponse response) {
        stream_.expires_after(response_limit);
        const auto [failed, size] =
            co_await bhttp::async_write(stream_, response, asio::as_tuple(asio::use_awaitable));
        co_return !failed;
    }

    beast::tcp_stream stream_;
    beast::flat_buffer buffer_{header_limit + body_limit};
    HttpContext context_;
};

}  // namespace

asio::awaitable<void> serve_http(asio::ip::tcp::socket socket, HttpContext context) {
    // A stream may last for days: nothing of the HTTP connection stays with it.
    auto session = std::make_unique<Session>(std::move(socket), context);
    auto upgrade = co_await session->run();
    session.reset();
    if (!upgrade) {
        co_return;
    }
    auto transport = co_await stream::accept_websocket(
        std::move(upgrade->socket),
        std::move(upgrade->request),
        std::move(upgrade->unread)
    );
    auto settings = std::move(upgrade->settings);
    upgrade.reset();
    if (transport) {
        co_await stream::serve_subscriber(
            **transport,
            context.hub,
            std::move(settings),
            context.log
        );
    }
}

}  // namespace sweepcast::http
