// Messages of frame errors.
#include "server/frame/error.hpp"

#include <string>

namespace sweepcast::frame {

namespace {

class FrameCategory final : public boost::system::error_category {
public:
    [[nodiscard]] const char* name() const noexcept override { return "sweepcast.frame"; }

    [[nodiscard]] std::string message(int value) const override {
        switch (static_cast<errc>(value)) {
        case errc::length_malformed:
            return "the length of a message is malformed";
        case errc::message_too_long:
            return "a message is longer than accepted";
        case errc::compression_unknown:
            return "a frame's compression is not known";
        case errc::raw_size_out_of_range:
            return "a frame announces a bigger scan than there can be";
        case errc::raw_size_wrong:
            return "a frame's body is not of the announced size";
        case errc::compression_damaged:
            return "a frame's body does not decompress";
        case errc::scan_malformed:
            return "a frame's body is not a scan";
        case errc::too_many_samples:
            return "a scan has more samples than accepted";
        case errc::column_length_wrong:
            return "the columns of a scan do not fit each other";
        case errc::unit_unknown:
            return "a scan's unit of angle or distance is not known";
        case errc::angle_out_of_range:
            return "a scan's angle lies outside the circle";
        case errc::distance_out_of_range:
            return "a scan's distance is out of range";
        case errc::quality_out_of_range:
            return "a scan's quality is out of range";
        case errc::flag_out_of_range:
            return "a scan's flag is out of range";
        case errc::answer_type_unknown:
            return "a scan's answer type is not known";
        case errc::dictionary_unknown:
            return "a frame is compressed with a dictionary that is not known here";
        }
        return "unknown frame error " + std::to_string(value);
    }
};

}  // namespace

const boost::system::error_category& frame_category() {
    static const FrameCategory category;
    return category;
}

}  // namespace sweepcast::frame
