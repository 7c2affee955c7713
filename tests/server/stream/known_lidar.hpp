// A lidar that a test's hub knows.
#pragma once

#include "server/hub/local_hub.hpp"
#include "server/stream/messages.hpp"

#include <memory>

namespace sweepcast::stream {

inline hub::LidarSnapshotPtr known_lidar() {
    auto lidar = std::make_shared<hub::LidarSnapshot>();
    lidar->number = 1;
    lidar->id = "A0E1C2D3";
    lidar->port_name = "ttyUSB0";
    lidar->url = "/dev/ttyUSB0";
    lidar->state.phase = device::Phase::scanning;
    lidar->state.info = protocol::DeviceInfo{
        .model = 0x18,
        .firmware_major = 1,
        .firmware_minor = 29,
        .hardware = 7,
        .serial = {0xA0, 0xE1, 0xC2, 0xD3}};
    lidar->state.health = protocol::Health{protocol::HealthStatus::warning, 7};
    lidar->state.modes = {
        {.name = "Express",
         .answer_type = protocol::AnswerType::express,
         .sample_duration = std::chrono::microseconds(250),
         .id = 0,
         .max_distance_mm = 12000.0,
         .typical = true}};
    lidar->state.mode = "Express";
    lidar->state.alias = "A1M8-R6";
    lidar->state.rotation = {
        .control = device::SpeedControl::duty,
        .wanted_hz = 7.0,
        .measured_hz = 6.97,
        .settled = true,
        .usual_hz = 10.0,
        .min_hz = 5.0,
        .max_hz = 15.0,
        .warning = "slow"};
    lidar->state.line = {
        .baud = 115200,
        .bytes = 1000,
        .samples = 320,
        .checksum_errors = 3,
        .skipped_bytes = 2,
        .lost_packets = 1};
    return lidar;
}

inline void add_known_lidar(hub::LocalHub& hub) {
    const auto lidar = known_lidar();
    hub.deliver(hub::StateNews{lidar, state_message(*lidar)});
}

}  // namespace sweepcast::stream
