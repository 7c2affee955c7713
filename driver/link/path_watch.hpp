// PathWatch: tells at once when a device file came, went or changed.
#pragma once

#include <boost/asio/any_io_executor.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <sys/stat.h>

namespace sweepcast::link {

/// What there is at a path, links followed; two looks differ if the file there came, went, is
/// another one or may be opened by others. That someone reads or writes it makes no difference.
class PathLook {
public:
    /// Looks at `path` now.
    explicit PathLook(const std::string& path);
    [[nodiscard]] bool there() const { return found_.has_value(); }
    bool operator==(const PathLook& other) const;

private:
    std::optional<struct stat> found_;
};

/// Watches a path that need not be there, and the links and directories on the way to it, by
/// inotify; where the system refuses that, it looks four times a second.
class PathWatch {
public:
    /// `on_change` is called on `executor` after every change since now, and may assume that this
    /// object is alive, and destroy it.
    PathWatch(
        const boost::asio::any_io_executor& executor,
        std::string path,
        std::function<void()> on_change
    );
    PathWatch(const PathWatch&) = delete;
    PathWatch& operator=(const PathWatch&) = delete;
    ~PathWatch();

private:
    class State;
    std::shared_ptr<State> state_;  // waits hold it weakly: their handlers may outlive this object
};

}  // namespace sweepcast::link
