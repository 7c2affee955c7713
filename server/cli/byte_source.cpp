#include "server/cli/byte_source.hpp"

#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::cli {

namespace {

Problem cannot_read(const std::string& name, int number) {
    const error_code code(number, boost::system::generic_category());
    const bool missing = code == boost::system::errc::no_such_file_or_directory;
    return {
        code,
        fmt::format("cannot read {}: {}", name, code.message()),
        missing ? "name a capture or a file with raw measurement bytes, or - for standard input"
                : ""};
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

Result<bool, Problem> PeekSource::begins_with(std::string_view text) {
    const auto differs = [&] {
        return !std::equal(
            seen_.begin(),
            seen_.begin() + static_cast<std::ptrdiff_t>(std::min(seen_.size(), text.size())),
            text.begin(),
            [](std::uint8_t byte, char c) { return byte == static_cast<std::uint8_t>(c); }
        );
    };
    while (seen_.size() < text.size() && !differs()) {
        const auto block = source_->next();
        if (!block) {
            return block.error();
        }
        if (block->empty()) {
            return false;
        }
        seen_.insert(seen_.end(), block->begin(), block->end());
    }
    return !differs();
}

Result<std::span<const std::uint8_t>, Problem> PeekSource::next() {
    if (seen_.empty()) {
        return source_->next();
    }
    given_ = std::exchange(seen_, {});
    return std::span<const std::uint8_t>(given_);
}

}  // namespace sweepcast::cli
