// JSON of the schema's messages, as the API and the command line write and read it. It is
// protobuf's JSON mapping with two differences: fields have the names that the schema gives them,
// and 64-bit integers up to 2^53 are numbers. Greater ones are strings, as in protobuf's mapping.
#pragma once

#include "driver/protocol/result.hpp"

#include <google/protobuf/message.h>

#include <string>

namespace sweepcast::api {

/// Returns the message as JSON on several lines, including fields with their default value.
[[nodiscard]] std::string to_json(const google::protobuf::Message& message);

/// Returns the same on one line, which ends with a newline.
[[nodiscard]] std::string to_json_line(const google::protobuf::Message& message);

/// Fills `message` from JSON. Empty text leaves it as it is. Names may be the schema's or
/// lowerCamelCase; a text field also takes a whole number. The error says what is wrong with the
/// text.
[[nodiscard]] Result<void, std::string>
from_json(const std::string& text, google::protobuf::Message& message);

}  // namespace sweepcast::api
