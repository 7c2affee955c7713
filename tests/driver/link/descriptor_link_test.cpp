// A device whose file vanishes while it is open, played by a named pipe: unlike a terminal it does
// not hang up then.
#include "driver/link/descriptor_link.hpp"

#include "tests/driver/link/link_fixture.hpp"
#include "tests/driver/link/scratch_directory.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <stdexcept>
#include <sys/stat.h>

namespace sweepcast::link {
namespace {

using namespace std::chrono_literals;

class PipePeer {
public:
    PipePeer() {
        if (::mkfifo(path_.c_str(), S_IRUSR | S_IWUSR) != 0) {
            throw std::runtime_error("no named pipe to be had");
        }
    }
    /// What is written to it comes back.
    boost::asio::posix::stream_descriptor open(boost::asio::io_context& context) const {
        const int fd = ::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        return {context, fd};
    }
    std::unique_ptr<Link> make_link(boost::asio::io_context& context) const {
        return std::make_unique<DescriptorLink>(open(context), path_, 115200);
    }
    void change_permissions() const {
        std::filesystem::permissions(path_, std::filesystem::perms::owner_all);
    }
    void vanish() const { std::filesystem::remove(path_); }
    void be_replaced() const {
        vanish();
        (void)scratch_.file("port", "");
    }

private:
    ScratchDirectory scratch_;
    std::string path_{(scratch_.root() / "port").string()};
};

using DescriptorLinkTest = LinkFixture<PipePeer>;

TEST_F(DescriptorLinkTest, ClosesItselfWhenItsDeviceFileVanishes) {
    Pending<std::size_t> reading;
    start_read(reading, buffer_, in(10s));
    peer_.vanish();
    EXPECT_EQ(finish(reading).error(), errc::disconnected);
    EXPECT_EQ(write(Bytes{7}, in(10s)).error(), errc::disconnected);
}

TEST_F(DescriptorLinkTest, ClosesItselfWhenAnotherFileTakesTheName) {
    Pending<std::size_t> reading;
    start_read(reading, buffer_, in(10s));
    peer_.be_replaced();
    EXPECT_EQ(finish(reading).error(), errc::disconnected);
}

TEST_F(DescriptorLinkTest, EndsAWriteThatCannotGoOnWhenItsDeviceFileVanishes) {
    const Bytes more_than_fits(1 << 20);
    Pending<void> writing;
    start(writing, link_->write_all(more_than_fits, in(10s)));
    peer_.vanish();
    EXPECT_EQ(finish(writing).error(), errc::disconnected);
}

TEST_F(DescriptorLinkTest, NoticesAlsoWhatVanishedBeforeItWasWatched) {
    PipePeer gone;
    auto descriptor = gone.open(context_);
    gone.vanish();
    DescriptorLink link(std::move(descriptor), "/nonexistent/port", 115200);
    Pending<std::size_t> reading;
    start(reading, link.read_some(buffer_, in(10s)));
    EXPECT_EQ(finish(reading).error(), errc::disconnected);
}

TEST_F(DescriptorLinkTest, StaysOpenWhenOnlyItsPermissionsChange) {
    peer_.change_permissions();
    EXPECT_EQ(read(buffer_, in(100ms)).error(), errc::timed_out);
    ASSERT_TRUE(write(Bytes{7}, in(10s)));
    EXPECT_EQ(read_exactly(1), Bytes{7});
}

}  // namespace
}  // namespace sweepcast::link
