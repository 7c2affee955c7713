#include "server/cli/answer_type_names.hpp"

#include <fmt/format.h>

#include <array>

namespace sweepcast::cli {

namespace {

using protocol::AnswerType;

struct Named {
    AnswerType type;
    std::string_view name;
};

constexpr std::array all{
    Named{AnswerType::normal, "normal"},
    Named{AnswerType::express, "express"},
    Named{AnswerType::hq, "hq"},
    Named{AnswerType::ultra, "ultra"},
    Named{AnswerType::dense, "dense"},
    Named{AnswerType::ultra_dense, "ultra-dense"}};

std::string number_of(const Named& named) {
    return fmt::format("{:#x}", static_cast<unsigned>(named.type));
}

std::string shown(const Named& named) {
    return fmt::format("{} ({})", number_of(named), named.name);
}

}  // namespace

Result<protocol::AnswerType, Problem> parse_answer_type(std::string_view text) {
    for (const auto& named : all) {
        const auto number = number_of(named);
        if (text == named.name || text == number || text == number.substr(2)) {
            return named.type;
        }
    }
    return Problem{
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("there is no answer type \"{}\"", text),
        "known are " + known_answer_types()};
}

std::string shown_answer_type(protocol::AnswerType type) {
    for (const auto& named : all) {
        if (named.type == type) {
            return shown(named);
        }
    }
    return fmt::format("{:#x}", static_cast<unsigned>(type));
}

std::string known_answer_types() {
    std::string list;
    for (const auto& named : all) {
        list += (list.empty() ? "" : ", ") + shown(named);
    }
    return list;
}

}  // namespace sweepcast::cli
