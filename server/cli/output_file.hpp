// OutputFile: a file that a command writes for its user, or standard output.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>

namespace sweepcast::cli {

/// What to do with a file that is there already. Devices and pipes are written to in any case.
enum class Existing : std::uint8_t {
    refuse,
    replace,
};

/// Writes are blocking; a reader at the other end of a pipe that takes nothing for five seconds is
/// an error.
class OutputFile {
public:
    /// Begins the file at `path`; "-" is standard output. The Problem says why it cannot be.
    static Result<OutputFile, Problem> create(const std::string& path, Existing existing);

    OutputFile(OutputFile&&) noexcept;
    OutputFile& operator=(OutputFile&&) noexcept;
    ~OutputFile();

    /// Goes bad when a write fails. What is flushed has been handed to the system.
    [[nodiscard]] std::ostream& stream();

    /// Why the first write that failed did, if one did.
    [[nodiscard]] error_code error() const;

    /// Flushes and closes. Gives error(), or why the system could not keep what it had taken.
    error_code close();

private:
    class Buffer;
    explicit OutputFile(std::unique_ptr<Buffer> buffer);

    std::unique_ptr<Buffer> buffer_;
    std::unique_ptr<std::ostream> stream_;
};

/// Why create() would fail, as far as can be told without creating anything: before much is done
/// for what cannot be written then.
[[nodiscard]] Result<void, Problem> check_output(const std::string& path, Existing existing);

}  // namespace sweepcast::cli
