// FakeScanner: answers requests on a Line as a scanner would, at once, and lets a test spoil its
// answers.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/request.hpp"
#include "driver/protocol/request_parser.hpp"
#include "tests/driver/device/memory_link.hpp"

#include <cstdint>
#include <vector>

namespace sweepcast::device {

class FakeScanner {
public:
    explicit FakeScanner(Line& line);

    /// Sends a full turn of samples in answer type 0x81, one a degree, the first one marked.
    void send_turn();

    /// How often a command has come.
    [[nodiscard]] std::size_t count(protocol::Command command) const;

    protocol::DeviceInfo info{
        .model = 0x18,
        .firmware_major = 1,
        .firmware_minor = 29,
        .hardware = 7,
        .serial = {0xA0, 0xE1}};
    protocol::Health health{};
    bool answers{true};
    /// Turns sent at once when a scan is started.
    int turns_at_start{3};
    /// A RESET makes it healthy.
    bool reset_heals{true};
    std::vector<protocol::Request> requests;

private:
    void obey(const protocol::Request& request);
    void reply(protocol::ReplyType type, std::span<const std::uint8_t> payload);

    Line& line_;
    protocol::RequestParser parser_;
};

}  // namespace sweepcast::device
