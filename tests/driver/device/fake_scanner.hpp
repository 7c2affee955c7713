// FakeScanner: answers requests on a Line as a scanner would, at once, and lets a test spoil its
// answers.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/lidar_conf.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/request.hpp"
#include "driver/protocol/request_parser.hpp"
#include "tests/driver/device/memory_link.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepcast::device {

class FakeScanner {
public:
    explicit FakeScanner(Line& line);

    /// Sends a full turn of samples in answer type 0x81, one a degree, the first one marked.
    void send_turn();
    void send_sample(unsigned degree);

    /// How often a command has come.
    [[nodiscard]] std::size_t count(protocol::Command command) const;

    /// The requests that have come since the latest one to scan.
    [[nodiscard]] std::span<const protocol::Request> since_scan() const;

    protocol::DeviceInfo info{
        .model = 0x18,
        .firmware_major = 1,
        .firmware_minor = 29,
        .hardware = 7,
        .serial = {0xA0, 0xE1}};
    protocol::Health health{};
    bool answers{true};
    /// Answers to GET_LIDAR_CONF by type and mode; without an entry it is the bare echo.
    std::map<std::pair<protocol::ConfType, std::uint16_t>, std::vector<std::uint8_t>> conf;
    /// Old firmware does not answer GET_LIDAR_CONF at all, nor GET_SAMPLERATE.
    bool knows_conf{true};
    bool knows_sample_rate{true};
    /// What it says to SET_LIDAR_CONF (0: done; none: nothing), and whether it keeps what was set.
    std::optional<std::uint32_t> set_conf_result{0};
    bool keeps_conf{true};
    /// The accessory board; none: GET_ACC_BOARD_FLAG is not answered.
    std::optional<protocol::AccessoryBoard> board;
    /// The only line speed that it understands.
    std::uint32_t baud{115200};
    /// Whether it can be talked into another.
    bool negotiates{};
    /// Turns sent at once when a scan is started.
    int turns_at_start{3};
    /// A RESET makes it healthy.
    bool reset_heals{true};
    std::vector<protocol::Request> requests;

    /// Gives it a list of modes: Standard (0x81, 500 us, 12 m), and "DenseBoost" (0x85, 31.25 us,
    /// 40 m) and "Boost" (0x84, 63 us, 25 m), of which the last is the typical one.
    void list_modes();

private:
    void understand(std::span<const std::uint8_t> bytes);
    void measure_speed(std::span<const std::uint8_t> bytes);
    void answer_conf(const protocol::Request& request);
    void set_conf(std::span<const std::uint8_t> payload);
    void list_mode(
        std::uint16_t id,
        std::string_view name,
        protocol::AnswerType type,
        std::uint32_t duration_q8,
        std::uint32_t distance_q8
    );
    void obey(const protocol::Request& request);
    void reply(protocol::ReplyType type, std::span<const std::uint8_t> payload);

    Line& line_;
    protocol::RequestParser parser_;
};

}  // namespace sweepcast::device
