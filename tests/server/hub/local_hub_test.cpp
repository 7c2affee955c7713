// LocalHub: who gets what on one worker.
#include "server/hub/local_hub.hpp"

#include "tests/server/hub/client_end.hpp"
#include "tests/server/hub/wire_messages.hpp"

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sweepcast::hub {
namespace {

namespace asio = boost::asio;
using frame::Compression;
using testing::ElementsAre;

class LocalHubTest : public testing::Test {
protected:
    struct Client {
        explicit Client(LocalHubTest& test)
            : end(test.context)
            , subscription(test.hub, end.outbox) {}
        ClientEnd end;
        LocalHub::Subscription subscription;
    };

    static SweepNews sweep(std::uint32_t lidar, const std::string& name) {
        SweepNews news;
        news.lidar = lidar;
        news.sweep = std::make_shared<const device::CapturedSweep>();
        news.frames = {message(name + " zstd"), message(name + " none")};
        return news;
    }

    static StateNews
    state(std::uint32_t number, const std::string& id, const std::string& port_name) {
        auto lidar = std::make_shared<LidarSnapshot>();
        lidar->number = number;
        lidar->id = id;
        lidar->port_name = port_name;
        return {lidar, message("state of " + id)};
    }

    /// What has come to the client since the last call.
    static std::vector<std::string> received(Client& client) {
        client.end.read_all();
        std::vector<std::string> texts;
        for (const auto& message : client.end.take()) {
            texts.push_back(message.closing().reason());
        }
        return texts;
    }

    asio::io_context context;
    Demand demand{};
    LocalHub hub{demand};
};

TEST_F(LocalHubTest, DeliversToThoseWhoWantTheLidar) {
    Client all(*this);
    Client second_only(*this);
    all.subscription.set_wish(Wish{});
    second_only.subscription.set_wish(Wish{.lidar = 2});
    hub.deliver(sweep(1, "first"));
    hub.deliver(sweep(2, "second"));
    EXPECT_THAT(received(all), ElementsAre("first zstd", "second zstd"));
    EXPECT_THAT(received(second_only), ElementsAre("second zstd"));
}

TEST_F(LocalHubTest, DeliversTheCompressionThatIsWanted) {
    Client client(*this);
    client.subscription.set_wish(Wish{.lidar = {}, .compression = Compression::none});
    hub.deliver(sweep(1, "sweep"));
    EXPECT_THAT(received(client), ElementsAre("sweep none"));
}

TEST_F(LocalHubTest, DeliversNoFramesWithoutAWish) {
    Client client(*this);
    hub.deliver(sweep(1, "sweep"));
    hub.deliver(state(1, "A0E1C2D3", "ttyUSB0"));
    EXPECT_THAT(received(client), ElementsAre("state of A0E1C2D3"));
}

TEST_F(LocalHubTest, DeliversNothingToOneWhoHasLeft) {
    Client stays(*this);
    stays.subscription.set_wish(Wish{});
    {
        Client leaves(*this);
        leaves.subscription.set_wish(Wish{});
    }
    hub.deliver(sweep(1, "sweep"));
    EXPECT_THAT(received(stays), ElementsAre("sweep zstd"));
}

TEST_F(LocalHubTest, CountsTheDemandForEachCompression) {
    Client client(*this);
    client.subscription.set_wish(Wish{});
    EXPECT_EQ(demand[0], 1U);
    client.subscription.set_wish(Wish{.lidar = {}, .compression = Compression::none});
    EXPECT_EQ(demand[0], 0U);
    EXPECT_EQ(demand[1], 1U);
    client.subscription.set_wish(std::nullopt);
    EXPECT_EQ(hub.subscribers(), 0U);
}

TEST_F(LocalHubTest, FindsALidarByIdAndByPortName) {
    hub.deliver(state(1, "ttyUSB0", "ttyUSB0"));
    hub.deliver(state(1, "A0E1C2D3", "ttyUSB0"));
    ASSERT_NE(hub.find("A0E1C2D3"), nullptr);
    EXPECT_EQ(hub.find("ttyUSB0"), hub.find("A0E1C2D3"));
    EXPECT_EQ(hub.find("nothing"), nullptr);
    EXPECT_EQ(hub.lidars().size(), 1U);
}

TEST_F(LocalHubTest, KeepsTheLatestSweep) {
    EXPECT_EQ(hub.latest_sweep(1), nullptr);
    const auto news = sweep(1, "sweep");
    hub.deliver(news);
    EXPECT_EQ(hub.latest_sweep(1), news.sweep);
    EXPECT_EQ(hub.latest_sweep(0), nullptr);
    EXPECT_EQ(hub.latest_sweep(2), nullptr);
}

TEST_F(LocalHubTest, ClosingAllSaysFarewellToEveryClient) {
    Client client(*this);
    hub.close_all(message("farewell"), "over");
    EXPECT_THAT(received(client), ElementsAre("farewell"));
    EXPECT_EQ(client.end.outbox.end_reason(), "over");
}

}  // namespace
}  // namespace sweepcast::hub
