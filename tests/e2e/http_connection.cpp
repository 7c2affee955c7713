// The HTTP half of gateway.hpp, apart because Beast is slow to compile.
#include "tests/e2e/gateway.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include <algorithm>
#include <cctype>

namespace sweepcast::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = beast::http;

struct HttpConnection::Socket {
    asio::io_context context;
    asio::ip::tcp::socket socket{context};
    beast::flat_buffer buffer;

    HttpAnswer read(bool head = false) {
        bhttp::response_parser<bhttp::string_body> parser;
        parser.skip(head);
        parser.body_limit(64 << 20);
        bhttp::read(socket, buffer, parser);
        const auto& response = parser.get();
        HttpAnswer answer{static_cast<int>(response.result_int()), {}, response.body()};
        for (const auto& field : response) {
            std::string name(field.name_string());
            std::ranges::transform(name, name.begin(), [](unsigned char c) {
                return static_cast<char>(std::tolower(c));
            });
            answer.headers.emplace_back(name, std::string(field.value()));
        }
        return answer;
    }
};

std::string HttpAnswer::header(const std::string& name) const {
    const auto found =
        std::ranges::find(headers, name, [](const auto& entry) { return entry.first; });
    return found == headers.end() ? "" : found->second;
}

HttpConnection::HttpConnection(const std::string& address) : socket_(std::make_unique<Socket>()) {
    const auto colon = address.rfind(':');
    asio::ip::tcp::resolver resolver(socket_->context);
    asio::connect(
        socket_->socket,
        resolver.resolve(address.substr(0, colon), address.substr(colon + 1))
    );
}

HttpConnection::~HttpConnection() = default;

HttpAnswer HttpConnection::ask(
    const std::string& method,
    const std::string& target,
    const std::string& body,
    const std::vector<std::pair<std::string, std::string>>& headers
) {
    bhttp::request<bhttp::string_body> request;
    request.method_string(method);
    request.target(target);
    request.version(11);
    request.set(bhttp::field::host, "localhost");
    for (const auto& [name, value] : headers) {
        request.set(name, value);
    }
    request.body() = body;
    request.prepare_payload();
    bhttp::write(socket_->socket, request);
    return socket_->read(method == "HEAD");
}

HttpAnswer HttpConnection::send_raw(const std::string& bytes) {
    asio::write(socket_->socket, asio::buffer(bytes));
    return socket_->read();
}

}  // namespace sweepcast::test
