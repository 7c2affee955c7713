#include "server/api/json.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace sweepcast::api {

namespace {

namespace json = boost::json;
using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

/// Returns whether `text` is a whole number that every reader of JSON holds exactly: many keep
/// numbers as doubles (RFC 8259, 6).
bool is_exact_number(std::string_view text) {
    constexpr std::int64_t largest = std::int64_t{1} << 53;
    std::int64_t value = 0;
    const auto* end = text.data() + text.size();
    const auto [rest, failed] = std::from_chars(text.data(), end, value);
    return failed == std::errc{} && rest == end && value >= -largest && value <= largest;
}

bool is_64_bit_integer(const FieldDescriptor* field) {
    return field != nullptr && (field->cpp_type() == FieldDescriptor::CPPTYPE_INT64 ||
                                field->cpp_type() == FieldDescriptor::CPPTYPE_UINT64);
}

/// Returns the position after the string that begins at `begin`.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
    auto at = begin + 1;
    while (text[at] != '"') {
        at += text[at] == '\\' ? 2U : 1U;
    }
    return at + 1;
}

/// Takes the quotes off the 64-bit integers in `text`, which protobuf printed for a message of
/// type `root`. Protobuf's mapping quotes all of them because some do not fit into a double.
std::string with_numbers(std::string_view text, const Descriptor& root) {
    struct Object {
        const Descriptor* type;
        const FieldDescriptor* field;  ///< whose value comes next
    };
    std::vector<Object> open;
    std::string out;
    out.reserve(text.size());
    for (std::size_t at = 0; at < text.size();) {
        if (text[at] != '"') {
            if (text[at] == '{') {
                const auto* field = open.empty() ? nullptr : open.back().field;
                const auto* type = field != nullptr ? field->message_type() : nullptr;
                open.push_back({open.empty() ? &root : type, nullptr});
            } else if (text[at] == '}') {
                open.pop_back();
            }
            out += text[at++];
            continue;
        }
        const auto end = end_of_string(text, at);
        const auto quoted = text.substr(at, end - at);
        const auto content = quoted.substr(1, quoted.size() - 2);
        auto& object = open.back();
        if (text[end] == ':') {
            object.field = object.type != nullptr
                               ? object.type->FindFieldByName(std::string(content))
                               : nullptr;
            out += quoted;
        } else {
            out += is_64_bit_integer(object.field) && is_exact_number(content) ? content : quoted;
        }
        at = end;
    }
    return out;
}

std::string print(const google::protobuf::Message& message, bool add_whitespace) {
    google::protobuf::util::JsonPrintOptions options;
    options.always_print_primitive_fields = true;
    options.preserve_proto_field_names = true;
    options.add_whitespace = add_whitespace;
    std::string text;
    const auto status = google::protobuf::util::MessageToJsonString(message, &text, options);
    if (!status.ok()) {
        throw std::logic_error("a message has no JSON form: " + status.ToString());
    }
    return with_numbers(text, *message.GetDescriptor());
}

/// Returns `text` with whole numbers as strings where `type` has a text field: a scan mode's id may
/// be written as 0 or as "0". What is no JSON object is returned as it is.
std::string with_texts(const std::string& text, const Descriptor& type) {
    error_code failed;
    auto value = json::parse(text, failed);
    if (failed || !value.is_object()) {
        return text;
    }
    bool changed = false;
    for (auto& member : value.get_object()) {
        const auto* field = type.FindFieldByName(std::string(member.key()));
        const bool is_number = member.value().is_int64() || member.value().is_uint64();
        if (is_number && field != nullptr && !field->is_repeated() &&
            field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
            member.value() = json::serialize(member.value());
            changed = true;
        }
    }
    return changed ? json::serialize(value) : text;
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
    const auto status = google::protobuf::util::JsonStringToMessage(
        with_texts(text, *message.GetDescriptor()),
        &message
    );
    if (!status.ok()) {
        return std::string(status.message());
    }
    return Result<void, std::string>{};
}

}  // namespace sweepcast::api
