// What can be wrong with bytes from a scanner: the error codes of the protocol room.
#pragma once

#include <boost/system/error_category.hpp>
#include <boost/system/error_code.hpp>

#include <type_traits>

namespace sweepcast::protocol {

/// Errors of the protocol. `message()` of each is a sentence for an operator.
enum class errc {
    checksum_mismatch = 1,    ///< the checksum of a packet differs from its content
    length_out_of_range,      ///< a length that this answer cannot have
    unsupported_answer_type,  ///< the scanner announced a stream that is not decoded here
    malformed_reply,          ///< a value in a reply that its field cannot hold
    conf_type_mismatch,       ///< an answer to another configuration question than was asked
    conf_not_supported,       ///< the scanner does not know this configuration value
    conf_refused,             ///< the scanner would not take this configuration value
};

/// The category "sweepcast.protocol".
[[nodiscard]] const boost::system::error_category& protocol_category() noexcept;

/// Lets an errc stand where an error_code is wanted.
[[nodiscard]] boost::system::error_code make_error_code(errc code) noexcept;

}  // namespace sweepcast::protocol

template <>
struct boost::system::is_error_code_enum<sweepcast::protocol::errc> : std::true_type {};
