// Device files that come and go, played by ordinary files.
#include "driver/link/path_watch.hpp"

#include "tests/driver/link/pty_pair.hpp"
#include "tests/driver/link/scratch_directory.hpp"

#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <sys/resource.h>

namespace sweepcast::link {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// While it lives this process can open nothing.
class NoMoreDescriptors {
public:
    NoMoreDescriptors() {
        ::getrlimit(RLIMIT_NOFILE, &usual_);
        const rlimit none{0, usual_.rlim_max};
        ::setrlimit(RLIMIT_NOFILE, &none);
    }
    NoMoreDescriptors(const NoMoreDescriptors&) = delete;
    NoMoreDescriptors& operator=(const NoMoreDescriptors&) = delete;
    ~NoMoreDescriptors() { ::setrlimit(RLIMIT_NOFILE, &usual_); }

private:
    rlimit usual_{};
};

class PathWatchTest : public testing::Test {
protected:
    void watch(const std::string& path) {
        path_ = path;
        watch_ = std::make_unique<PathWatch>(context_.get_executor(), path, [this] { ++changes_; });
    }

    /// Waits until a change was told after those told before, at most a minute.
    bool told() {
        const auto give_up = std::chrono::steady_clock::now() + 60s;
        context_.restart();
        while (changes_ == 0 && context_.run_one_until(give_up) != 0) {
        }
        return std::exchange(changes_, 0) > 0;
    }
    [[nodiscard]] bool there() const { return PathLook(path_).there(); }

    ScratchDirectory scratch_;
    boost::asio::io_context context_;
    std::string path_;
    int changes_{};
    std::unique_ptr<PathWatch> watch_;
};

TEST_F(PathWatchTest, TellsThatAFileCameAndWent) {
    watch((scratch_.root() / "port").string());
    scratch_.file("port", "");
    EXPECT_TRUE(told());
    EXPECT_TRUE(there());
    fs::remove(path_);
    EXPECT_TRUE(told());
    EXPECT_FALSE(there());
    scratch_.file("port", "");
    EXPECT_TRUE(told());
}

TEST_F(PathWatchTest, TellsThatOthersMayOpenIt) {
    watch(scratch_.file("port", "").string());
    fs::permissions(path_, fs::perms::owner_read);
    EXPECT_TRUE(told());
}

TEST_F(PathWatchTest, TellsThatAnotherFileTookTheName) {
    watch(scratch_.file("port", "").string());
    fs::rename(scratch_.file("other", ""), path_);
    EXPECT_TRUE(told());
    EXPECT_TRUE(there());
}

TEST_F(PathWatchTest, SeesThroughDirectoriesThatAreNotThereYet) {
    watch((scratch_.root() / "serial/by-id/port").string());
    scratch_.file("serial/by-id/port", "");
    EXPECT_TRUE(told());
    fs::remove_all(scratch_.root() / "serial");
    EXPECT_TRUE(told());
    EXPECT_FALSE(there());
    scratch_.file("serial/by-id/port", "");
    EXPECT_TRUE(told());
    EXPECT_TRUE(there());
}

TEST_F(PathWatchTest, SeesThroughALinkWhoseTargetComesAndGoes) {
    scratch_.link("link", "../" + scratch_.root().filename().string() + "/device/port");
    watch((scratch_.root() / "link").string());
    scratch_.file("device/port", "");
    EXPECT_TRUE(told());
    EXPECT_TRUE(there());
    fs::remove(scratch_.root() / "device/port");
    EXPECT_TRUE(told());
    EXPECT_FALSE(there());
}

TEST_F(PathWatchTest, SeesALinkLeadElsewhere) {
    const auto one = scratch_.file("one", "");
    const auto two = scratch_.file("two", "");
    scratch_.link("link", one);
    watch((scratch_.root() / "link").string());
    fs::remove(scratch_.root() / "link");
    scratch_.link("link", two);
    EXPECT_TRUE(told());
    EXPECT_TRUE(there());
    fs::remove(two);
    EXPECT_TRUE(told());
    EXPECT_FALSE(there());
}

TEST_F(PathWatchTest, IsNotCaughtInALoopOfLinks) {
    scratch_.link("link", "other");
    scratch_.link("other", "link");
    watch((scratch_.root() / "link").string());
    EXPECT_FALSE(there());
    fs::remove(scratch_.root() / "other");
    scratch_.file("other", "");
    EXPECT_TRUE(told());
    EXPECT_TRUE(there());
}

TEST_F(PathWatchTest, TellsThatAPseudoTerminalWentAndAnotherGotItsNumber) {
    auto first = std::make_unique<PtyPair>();
    const PathLook before(first->path());
    watch(first->path());
    first.reset();
    EXPECT_TRUE(told());
    // Another one of that number, made some clock ticks later; unless another process gets it.
    const auto give_up = std::chrono::steady_clock::now() + 60s;
    auto second = std::make_unique<PtyPair>();
    while (PathLook(path_) == before && std::chrono::steady_clock::now() < give_up) {
        second.reset();
        second = std::make_unique<PtyPair>();
    }
    if (second->path() == path_) {
        EXPECT_TRUE(told());
        EXPECT_TRUE(there());
    }
}

TEST_F(PathWatchTest, LooksNowAndThenWhereTheSystemRefusesToTell) {
    path_ = (scratch_.root() / "port").string();
    const auto executor = context_.get_executor();
    const auto on_change = [this] { ++changes_; };
    const PathWatch first(executor, "/", [] {});  // the context has its own descriptors by now
    {
        const NoMoreDescriptors limit;
        watch_ = std::make_unique<PathWatch>(executor, path_, on_change);
    }
    scratch_.file("port", "");
    EXPECT_TRUE(told());
    EXPECT_TRUE(there());
}

TEST_F(PathWatchTest, MayBeDestroyedByWhatItTells) {
    const auto path = (scratch_.root() / "port").string();
    watch_ = std::make_unique<PathWatch>(context_.get_executor(), path, [this] {
        ++changes_;
        watch_.reset();
    });
    scratch_.file("port", "");
    EXPECT_TRUE(told());
    context_.restart();
    context_.run_for(60s);
    EXPECT_TRUE(context_.stopped()) << "nothing is waited for any more";
}

}  // namespace
}  // namespace sweepcast::link
