// What a path leads through is watched, not the file: inotify tells of names that come and go.
#include "driver/link/path_watch.hpp"

#include "driver/link/owned_descriptor.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <set>
#include <sys/inotify.h>
#include <system_error>
#include <utility>

namespace sweepcast::link {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr auto look_unwatched = 250ms;  // where inotify is refused
constexpr auto look_anyway = 1s;        // file systems that tell nothing
constexpr auto rest_after_news = 10ms;  // a busy directory costs a hundred looks a second at most
constexpr int most_links = 8;

/// The directories in which a name decides what `path` leads to: that of the path, or the nearest
/// above it that is there, and those of the links that it leads through.
std::set<std::string> directories_to(const std::string& path) {
    std::set<std::string> directories;
    std::error_code ec;
    fs::path name = fs::absolute(path, ec);
    for (int links = 0; !ec && links < most_links; ++links) {
        fs::path directory = name.parent_path();
        std::error_code not_there;
        while (directory.has_relative_path() && !fs::is_directory(directory, not_there)) {
            directory = directory.parent_path();
        }
        directories.insert(directory.string());
        const fs::path target = fs::read_symlink(name, ec);
        name = name.parent_path() / target;
    }
    return directories;
}

/// An inotify descriptor that watches all of `directories`, and whether it really watches them all.
std::pair<OwnedDescriptor, bool> watch(const std::set<std::string>& directories) {
    constexpr std::uint32_t news = IN_CREATE | IN_DELETE | IN_MOVED_FROM | IN_MOVED_TO | IN_ATTRIB |
                                   IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;
    OwnedDescriptor inotify(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC));
    const bool all = inotify.get() >= 0 && std::ranges::all_of(directories, [&](const auto& each) {
                         return ::inotify_add_watch(inotify.get(), each.c_str(), news) >= 0;
                     });
    return {std::move(inotify), all};
}

}  // namespace

PathLook::PathLook(const std::string& path) {
    struct stat found {};
    if (::stat(path.c_str(), &found) == 0) {
        found_ = found;
    }
}

bool PathLook::operator==(const PathLook& other) const {
    if (!found_ || !other.found_) {
        return there() == other.there();
    }
    const auto& a = *found_;
    const auto& b = *other.found_;
    // The numbers of a pseudo terminal are used again at once; the time of its making tells.
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_rdev == b.st_rdev &&
           a.st_mode == b.st_mode && a.st_uid == b.st_uid && a.st_gid == b.st_gid &&
           a.st_ctim.tv_sec == b.st_ctim.tv_sec && a.st_ctim.tv_nsec == b.st_ctim.tv_nsec;
}

class PathWatch::State : public std::enable_shared_from_this<State> {
public:
    State(const asio::any_io_executor& executor, std::string path, std::function<void()> on_change)
        : path_(std::move(path))
        , on_change_(std::move(on_change))
        , inotify_(executor)
        , next_look_(executor)
        , rest_(executor)
        , seen_(path_) {}

    void start() {
        arm();
        await_look();
    }

    void stop() {
        on_change_ = nullptr;
        error_code ignored;  // the descriptor is gone even if closing reports an error
        inotify_.close(ignored);
        next_look_.cancel();
        rest_.cancel();
    }

private:
    /// Watches the directories that matter now.
    void arm() {
        auto directories = directories_to(path_);
        error_code ignored;  // as above
        inotify_.close(ignored);
        auto [inotify, all] = watch(directories);
        watched_ = all;
        directories_ = std::move(directories);
        if (inotify.get() < 0) {
            return;
        }
        error_code refused;
        inotify_.assign(inotify.get(), refused);
        if (refused) {
            watched_ = false;
            return;
        }
        (void)inotify.release();  // inotify_ owns it now
        await_news();
    }

    void await_news() {
        inotify_.async_wait(
            asio::posix::stream_descriptor::wait_read,
            [weak = weak_from_this()](const error_code& ended) {
                if (const auto self = ended ? nullptr : weak.lock()) {
                    self->on_news();
                }
            }
        );
    }

    void on_news() {
        rest_.expires_after(rest_after_news);
        rest_.async_wait([weak = weak_from_this()](const error_code& ended) {
            if (const auto self = ended ? nullptr : weak.lock()) {
                self->arm();  // throws away the news that came meanwhile, and with a look anew
                self->look();
            }
        });
        look();
    }

    void await_look() {
        next_look_.expires_after(watched_ ? look_anyway : look_unwatched);
        next_look_.async_wait([weak = weak_from_this()](const error_code& ended) {
            const auto self = ended ? nullptr : weak.lock();
            if (self == nullptr) {
                return;
            }
            self->await_look();
            if (!self->watched_ || directories_to(self->path_) != self->directories_) {
                self->arm();
            }
            self->look();
        });
    }

    void look() {
        const PathLook now(path_);
        if (now == seen_) {
            return;
        }
        seen_ = now;
        if (on_change_) {
            const auto call = on_change_;  // it may end this
            call();
        }
    }

    std::string path_;
    std::function<void()> on_change_;
    asio::posix::stream_descriptor inotify_;
    asio::steady_timer next_look_;
    asio::steady_timer rest_;
    PathLook seen_;
    std::set<std::string> directories_;
    bool watched_{};
};

PathWatch::PathWatch(
    const asio::any_io_executor& executor,
    std::string path,
    std::function<void()> on_change
)
    : state_(std::make_shared<State>(executor, std::move(path), std::move(on_change))) {
    state_->start();
}

PathWatch::~PathWatch() {
    state_->stop();
}

}  // namespace sweepcast::link
