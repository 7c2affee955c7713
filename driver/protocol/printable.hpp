// printable() and printable_start(): make text from outside the program safe to print.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sweepcast::protocol {

/// Returns `text` as valid UTF-8 that cannot control a terminal or forge a line of a log.
/// Use it where text from a lidar, a peer, a file or the system leaves the program.
///
/// | in the text                                        | becomes                    |
/// | -------------------------------------------------- | -------------------------- |
/// | line feed, carriage return, tab                    | `\n`, `\r`, `\t`           |
/// | other control characters: U+0000-001F, U+007F-009F | `\u` and four digits       |
/// | line and paragraph separators: U+2028, U+2029      | `\u` and four digits       |
/// | invisible characters (see below)                   | `\u` and four digits       |
/// | invisible characters beyond U+FFFF                 | a pair of these (UTF-16)   |
/// | a byte that is not part of valid UTF-8             | `\x` and two digits        |
/// | everything else, backslashes included              | stays                      |
///
/// Invisible characters could make two names look equal, or change the direction of the text. They
/// are those that Unicode calls default-ignorable, and the annotation marks U+FFF9-FFFB. Among the
/// default-ignorable ones are zero-width characters and direction marks (U+061C, U+200B-200F,
/// U+202A-202E, U+2060-206F, U+FEFF), variation selectors (U+FE00-FE0F) and tags (U+E0000-E007F).
///
/// Printable text stays as it is. Valid JSON on one line without raw tabs stays valid and means the
/// same.
std::string printable(std::string_view text);

/// Returns printable(text) if that has at most `most` bytes. Otherwise returns its first
/// characters, at most `most` bytes of them, and then `mark`. Neither a character nor an escape is
/// cut.
std::string printable_start(std::string_view text, std::size_t most, std::string_view mark = {});

}  // namespace sweepcast::protocol
