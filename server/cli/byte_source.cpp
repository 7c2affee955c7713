#include "server/cli/byte_source.hpp"

#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <unistd.h>

namespace sweepcast::cli {

namespace {

Problem cannot_read(const std::string& name, int number) {
    const error_code code(number, boost::system::generic_category());
    const bool missing = code == boost::system::errc::no_such_file_or_directory;
    return {
        code,
        fmt::format("cannot read {}: {}", name, code.message()),
        missing ? "name a file with raw measurement bytes, or - for standard input" : ""};
}

class FileSource final : public ByteSource {
public:
    FileSource(std::string name, int descriptor)
        : name_(std::move(name))
        , descriptor_(descriptor) {}
    ~FileSource() override {
        if (descriptor_ != STDIN_FILENO) {
            ::close(descriptor_);
        }
    }
    FileSource(const FileSource&) = delete;
    FileSource& operator=(const FileSource&) = delete;

    Result<std::span<const std::uint8_t>, Problem> next() override {
        ssize_t count = -1;
        do {
            count = ::read(descriptor_, block_.data(), block_.size());
        } while (count < 0 && errno == EINTR);
        if (count < 0) {
            return cannot_read(name_, errno);
        }
        return std::span<const std::uint8_t>(block_).first(static_cast<std::size_t>(count));
    }

private:
    std::string name_;
    int descriptor_;
    std::array<std::uint8_t, 16'384> block_{};
};

}  // namespace

Result<std::unique_ptr<ByteSource>, Problem> open_byte_source(const std::string& path) {
    if (path == "-") {
        return std::make_unique<FileSource>("standard input", STDIN_FILENO);
    }
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return cannot_read(path, errno);
    }
    return std::make_unique<FileSource>(path, descriptor);
}

}  // namespace sweepcast::cli
