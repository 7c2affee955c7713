// JSON by protobuf's mapping: the API has one schema, proto/sweepcast/v1.
#pragma once

#include "driver/protocol/result.hpp"

#include <google/protobuf/message.h>

#include <string>

namespace sweepcast::api {

/// The message as JSON, with fields that have their default value too, and a newline at the end.
[[nodiscard]] std::string to_json(const google::protobuf::Message& message);

/// The same in one line.
[[nodiscard]] std::string to_json_line(const google::protobuf::Message& message);

/// Fills `message` from JSON; empty text leaves it as it is. The error says what is wrong with the
/// text.
[[nodiscard]] Result<void, std::string>
from_json(const std::string& text, google::protobuf::Message& message);

}  // namespace sweepcast::api
