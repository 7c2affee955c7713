// The sentences behind the protocol's error codes.
#include "driver/protocol/error.hpp"

#include <string>

namespace sweepcast::protocol {
namespace {

class Category final : public boost::system::error_category {
public:
    const char* name() const noexcept override { return "sweepcast.protocol"; }

    std::string message(int value) const override {
        switch (static_cast<errc>(value)) {
        case errc::checksum_mismatch:
            return "a packet arrived damaged: its checksum does not match its content";
        case errc::length_out_of_range:
            return "a reply has a length that this kind of reply cannot have";
        case errc::unsupported_answer_type:
            return "the scanner answers with a measurement stream that is not supported";
        case errc::malformed_reply:
            return "a reply holds a value that its field cannot have";
        case errc::conf_type_mismatch:
            return "the scanner answered another configuration question than it was asked";
        case errc::conf_not_supported:
            return "the scanner does not know this configuration value";
        case errc::conf_refused:
            return "the scanner refused this configuration value";
        }
        return "unknown protocol error " + std::to_string(value);
    }
};

}  // namespace

const boost::system::error_category& protocol_category() noexcept {
    static const Category category;
    return category;
}

boost::system::error_code make_error_code(errc code) noexcept {
    return {static_cast<int>(code), protocol_category()};
}

}  // namespace sweepcast::protocol
