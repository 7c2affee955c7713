// Bytes -> requests, one byte at a time.
#include "driver/protocol/request_parser.hpp"

#include <utility>

namespace sweepcast::protocol {

std::optional<Request> RequestParser::push(std::uint8_t byte, SampleTime now) {
    if (waiting_ != Waiting::start && now - started_ > request_time_limit) {
        waiting_ = Waiting::start;
    }
    switch (waiting_) {
    case Waiting::start:
        if (byte == start_byte) {
            begin(now);
        }
        return std::nullopt;
    case Waiting::command:
        return take_command(byte, now);
    case Waiting::size:
        take_size(byte);
        return std::nullopt;
    case Waiting::payload:
        take_payload(byte);
        return std::nullopt;
    case Waiting::checksum:
        return take_checksum(byte, now);
    }
    return std::nullopt;
}

void RequestParser::begin(SampleTime now) {
    waiting_ = Waiting::command;
    started_ = now;
    checksum_ = start_byte;
}

std::optional<Request> RequestParser::take_command(std::uint8_t byte, SampleTime now) {
    if (byte == start_byte) {
        begin(now);
        return std::nullopt;
    }
    request_.command = static_cast<Command>(byte);
    request_.payload.clear();
    checksum_ = static_cast<std::uint8_t>(checksum_ ^ byte);
    if (carries_payload(request_.command)) {
        waiting_ = Waiting::size;
        return std::nullopt;
    }
    waiting_ = Waiting::start;
    return std::move(request_);
}

void RequestParser::take_size(std::uint8_t byte) {
    size_ = byte;
    checksum_ = static_cast<std::uint8_t>(checksum_ ^ byte);
    waiting_ = size_ == 0 ? Waiting::checksum : Waiting::payload;
}

void RequestParser::take_payload(std::uint8_t byte) {
    request_.payload.push_back(byte);
    checksum_ = static_cast<std::uint8_t>(checksum_ ^ byte);
    if (request_.payload.size() == size_) {
        waiting_ = Waiting::checksum;
    }
}

std::optional<Request> RequestParser::take_checksum(std::uint8_t byte, SampleTime now) {
    waiting_ = Waiting::start;
    if (byte == checksum_) {
        return std::move(request_);
    }
    if (byte == start_byte) {
        begin(now);
    }
    return std::nullopt;
}

}  // namespace sweepcast::protocol
