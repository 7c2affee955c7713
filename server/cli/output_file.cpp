#include "server/cli/output_file.hpp"

#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <streambuf>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::cli {

namespace {

error_code system_error(int number) {
    return {number, boost::system::generic_category()};
}

Problem cannot_write(const std::string& path, const error_code& code) {
    return {
        code,
        fmt::format("cannot write {}: {}", path, code.message()),
        "choose a file in a folder that exists and that you may write to"};
}

Problem exists_already(const std::string& path) {
    return {
        make_error_code(boost::system::errc::file_exists),
        path + " exists already",
        "choose another name, or --force to write it anew"};
}

std::string folder_of(const std::string& path) {
    const auto folder = std::filesystem::path(path).parent_path();
    return folder.empty() ? "." : folder.string();
}

}  // namespace

/// Collects what is written and hands it to a descriptor.
class OutputFile::Buffer final : public std::streambuf {
public:
    explicit Buffer(int descriptor) : descriptor_(descriptor) {
        setp(bytes_.data(), bytes_.data() + bytes_.size());
    }
    ~Buffer() override { close(); }
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;

    [[nodiscard]] error_code error() const { return error_; }

    void close() {
        if (descriptor_ == STDOUT_FILENO || descriptor_ < 0) {
            return;
        }
        if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) {
            fail(errno);
        }
    }

protected:
    int_type overflow(int_type c) override {
        if (sync() != 0) {
            return traits_type::eof();
        }
        if (!traits_type::eq_int_type(c, traits_type::eof())) {
            *pptr() = traits_type::to_char_type(c);
            pbump(1);
        }
        return traits_type::not_eof(c);
    }

    int sync() override {
        const char* next = pbase();
        while (next < pptr() && !error_) {
            next += write_some(next, static_cast<std::size_t>(pptr() - next));
        }
        setp(bytes_.data(), bytes_.data() + bytes_.size());
        return error_ ? -1 : 0;
    }

private:
    // So much fits into a pipe that poll() calls writable.
    static constexpr std::size_t most_at_once = 4096;
    static constexpr int patience_ms = 5000;

    std::ptrdiff_t write_some(const char* from, std::size_t count) {
        pollfd waiting{descriptor_, POLLOUT, 0};
        const int ready = ::poll(&waiting, 1, patience_ms);
        if (ready == 0) {
            fail(ETIMEDOUT);
            return 0;
        }
        const auto written = ready < 0 ? -1 : ::write(descriptor_, from, count);
        if (written >= 0) {
            return written;
        }
        if (errno != EINTR && errno != EAGAIN) {
            fail(errno);
        }
        return 0;
    }

    void fail(int number) {
        if (!error_) {
            error_ = system_error(number);
        }
    }

    int descriptor_;
    error_code error_;
    std::array<char, most_at_once> bytes_{};
};

OutputFile::OutputFile(std::unique_ptr<Buffer> buffer)
    : buffer_(std::move(buffer))
    , stream_(std::make_unique<std::ostream>(buffer_.get())) {}

OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

Result<OutputFile, Problem> OutputFile::create(const std::string& path, Existing existing) {
    if (path == "-") {
        return OutputFile(std::make_unique<Buffer>(STDOUT_FILENO));
    }
    struct stat there {};
    const bool is_file = ::stat(path.c_str(), &there) != 0 || S_ISREG(there.st_mode);
    int flags = O_WRONLY | O_CLOEXEC | O_NOCTTY;
    if (is_file) {
        flags |= O_CREAT | (existing == Existing::refuse ? O_EXCL : O_TRUNC);
    }
    constexpr mode_t usual_mode = 0666;  // less the umask
    const int descriptor = ::open(path.c_str(), flags, usual_mode);
    if (descriptor < 0) {
        const int number = errno;
        return number == EEXIST ? exists_already(path) : cannot_write(path, system_error(number));
    }
    return OutputFile(std::make_unique<Buffer>(descriptor));
}

std::ostream& OutputFile::stream() {
    return *stream_;
}

error_code OutputFile::error() const {
    return buffer_->error();
}

error_code OutputFile::close() {
    stream_->flush();
    buffer_->close();
    return buffer_->error();
}

Result<void, Problem> check_output(const std::string& path, Existing existing) {
    if (path == "-") {
        if (::isatty(STDOUT_FILENO) != 0) {
            return Problem{
                make_error_code(boost::system::errc::invalid_argument),
                "standard output is a terminal, which cannot show these bytes",
                "name a file with -o, or send standard output to a file or a pipe"};
        }
        return {};
    }
    struct stat there {};
    if (::stat(path.c_str(), &there) != 0) {
        const auto folder = folder_of(path);
        if (::access(folder.c_str(), W_OK | X_OK) != 0) {
            return cannot_write(path, system_error(errno));
        }
        return {};
    }
    if (S_ISDIR(there.st_mode)) {
        return cannot_write(path, system_error(EISDIR));
    }
    if (S_ISREG(there.st_mode) && existing == Existing::refuse) {
        return exists_already(path);
    }
    if (::access(path.c_str(), W_OK) != 0) {
        return cannot_write(path, system_error(errno));
    }
    return {};
}

}  // namespace sweepcast::cli
