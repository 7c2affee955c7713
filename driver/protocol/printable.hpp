// printable(): makes text from outside the program safe to print.
#pragma once

#include <string>
#include <string_view>

namespace sweepcast::protocol {

/// Returns `text` as valid UTF-8 that cannot control a terminal or forge a line of a log.
/// Use it where text from a lidar, a peer, a file or the system leaves the program.
///
/// | in the text                                            | becomes              |
/// | ------------------------------------------------------ | -------------------- |
/// | line feed, carriage return, tab                        | `\n`, `\r`, `\t`     |
/// | other control characters: U+0000-001F, U+007F-009F     | `\u` and four digits |
/// | line separators and direction marks (U+2028, U+202E..) | `\u` and four digits |
/// | a byte that is not part of valid UTF-8                 | `\x` and two digits  |
/// | everything else, backslashes included                  | stays                |
///
/// So printable text stays as it is, and valid JSON on one line stays valid and means the same.
std::string printable(std::string_view text);

}  // namespace sweepcast::protocol
