// Answer types as a person names them on the command line.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/result.hpp"

#include <string>
#include <string_view>

namespace sweepcast::cli {

/// The type that a number ("0x84", "84") or a name ("ultra") stands for. The problem lists all that
/// are known.
[[nodiscard]] Result<protocol::AnswerType, Problem> parse_answer_type(std::string_view text);

/// E.g. "0x84 (ultra)".
[[nodiscard]] std::string shown_answer_type(protocol::AnswerType type);

/// All of them, e.g. for a help text.
[[nodiscard]] std::string known_answer_types();

}  // namespace sweepcast::cli
