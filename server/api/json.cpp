#include "server/api/json.hpp"

#include <google/protobuf/util/json_util.h>

#include <stdexcept>

namespace sweepcast::api {

namespace {

std::string print(const google::protobuf::Message& message, bool add_whitespace) {
    google::protobuf::util::JsonPrintOptions options;
    options.always_print_primitive_fields = true;
    options.add_whitespace = add_whitespace;
    std::string text;
    const auto status = google::protobuf::util::MessageToJsonString(message, &text, options);
    if (!status.ok()) {
        throw std::logic_error("a message has no JSON form: " + status.ToString());
    }
    return text;
}

}  // namespace

std::string to_json(const google::protobuf::Message& message) {
    return print(message, true);
}

std::string to_json_line(const google::protobuf::Message& message) {
    return print(message, false) + "\n";
}

Result<void, std::string> from_json(const std::string& text, google::protobuf::Message& message) {
    if (text.empty()) {
        return Result<void, std::string>{};
    }
    const auto status = google::protobuf::util::JsonStringToMessage(text, &message);
    if (!status.ok()) {
        return std::string(status.message());
    }
    return Result<void, std::string>{};
}

}  // namespace sweepcast::api
