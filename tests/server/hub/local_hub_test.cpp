// LocalHub: who gets what on one worker.
#include "server/hub/local_hub.hpp"

#include "tests/server/hub/client_end.hpp"
#include "tests/server/hub/wire_messages.hpp"

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
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

    /// With a frame of every variant wanted, "first none" and the like.
    [[nodiscard]] SweepNews sweep(std::uint32_t lidar, const std::string& name) const {
        SweepNews news;
        news.lidar = lidar;
        news.sweep = captured(lidar, 1);
        news.frames = frames(lidar, name);
        return news;
    }
    [[nodiscard]] std::vector<VariantFrame> frames(std::uint32_t lidar, const std::string& name)
        const {
        std::vector<VariantFrame> frames;
        for (const auto& variant : variants.wanted(lidar)) {
            const auto compression = variant->wish().format.compression;
            const auto* suffix = compression == Compression::none ? " none" : " zstd";
            frames.push_back({variant, message(name + suffix)});
        }
        return frames;
    }

    static std::shared_ptr<const device::CapturedSweep>
    captured(std::uint32_t lidar, std::uint64_t sequence) {
        device::CapturedSweep sweep;
        sweep.lidar_number = lidar;
        sweep.sequence = sequence;
        sweep.sweep.samples.resize(2);
        return std::make_shared<const device::CapturedSweep>(std::move(sweep));
    }

    static Wish wish(std::optional<std::uint32_t> lidar, Compression compression) {
        Wish wish{.lidar = lidar, .frames = {}};
        wish.frames.format.compression = compression;
        return wish;
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
            texts.push_back(
                message.has_frame() ? "sweep " + std::to_string(message.frame().sequence())
                                    : message.closing().reason()
            );
        }
        return texts;
    }

    asio::io_context context;
    Variants variants;
    LocalHub hub{variants};
};

TEST_F(LocalHubTest, DeliversToThoseWhoWantTheLidar) {
    Client all(*this);
    Client second_only(*this);
    ASSERT_TRUE(all.subscription.set_wish(Wish{}));
    ASSERT_TRUE(second_only.subscription.set_wish(wish(2, Compression::zstd)));
    hub.deliver(sweep(1, "first"));
    hub.deliver(sweep(2, "second"));
    EXPECT_THAT(received(all), ElementsAre("first zstd", "second zstd"));
    EXPECT_THAT(received(second_only), ElementsAre("second zstd"));
}

TEST_F(LocalHubTest, DeliversTheCompressionThatIsWanted) {
    Client client(*this);
    ASSERT_TRUE(client.subscription.set_wish(wish({}, Compression::none)));
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
    ASSERT_TRUE(stays.subscription.set_wish(Wish{}));
    {
        Client leaves(*this);
        ASSERT_TRUE(leaves.subscription.set_wish(Wish{}));
    }
    hub.deliver(sweep(1, "sweep"));
    EXPECT_THAT(received(stays), ElementsAre("sweep zstd"));
}

TEST_F(LocalHubTest, ManyComeAndGoAndEachGetsItsOwn) {
    std::vector<std::unique_ptr<Client>> clients;
    for (int i = 0; i < 12; ++i) {
        clients.push_back(std::make_unique<Client>(*this));
        const auto lidar = i % 3 == 0 ? std::nullopt : std::optional<std::uint32_t>(i % 3);
        ASSERT_TRUE(clients.back()->subscription.set_wish(
            wish(lidar, i % 2 == 0 ? Compression::zstd : Compression::none)
        ));
    }
    clients.erase(clients.begin() + 4);  // wanted lidar 1 as zstd
    clients.erase(clients.begin() + 0);  // wanted all as zstd
    EXPECT_EQ(hub.subscribers(), 10U);
    hub.deliver(sweep(1, "first"));
    hub.deliver(sweep(2, "second"));
    const std::vector<int> numbers{1, 2, 3, 5, 6, 7, 8, 9, 10, 11};
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const auto i = numbers[k];
        const std::string suffix = i % 2 == 0 ? " zstd" : " none";
        std::vector<std::string> expected;
        if (i % 3 != 2) {
            expected.push_back("first" + suffix);
        }
        if (i % 3 != 1) {
            expected.push_back("second" + suffix);
        }
        EXPECT_EQ(received(*clients[k]), expected) << i;
    }
    clients.clear();
    EXPECT_EQ(hub.subscribers(), 0U);
    EXPECT_TRUE(variants.wanted(1).empty());
}

TEST_F(LocalHubTest, ALateSubscriberGetsTheLatestSweepThatOthersGot) {
    Client early(*this);
    ASSERT_TRUE(early.subscription.set_wish(Wish{}));
    hub.deliver(sweep(1, "first"));
    hub.deliver(sweep(2, "second"));
    Client late(*this);
    ASSERT_TRUE(late.subscription.set_wish(wish(2, Compression::zstd), message("answer")));
    EXPECT_THAT(received(late), ElementsAre("answer", "second zstd"));
    ASSERT_TRUE(late.subscription.set_wish(Wish{}));
    EXPECT_THAT(received(late), ElementsAre("first zstd", "second zstd"));
}

TEST_F(LocalHubTest, ALateSubscriberGetsTheLatestSweepInAFormThatNobodyHadWished) {
    hub.deliver(SweepNews{1, captured(1, 41), {}});
    Client late(*this);
    ASSERT_TRUE(late.subscription.set_wish(Wish{}));
    EXPECT_THAT(received(late), ElementsAre("sweep 41"));
    hub.deliver(sweep(1, "next"));
    EXPECT_THAT(received(late), ElementsAre("next zstd"));
}

TEST_F(LocalHubTest, ASweepThatWasEncodedJustBeforeTheWishIsNotMissed) {
    Client client(*this);
    ASSERT_TRUE(client.subscription.set_wish(Wish{}));
    hub.deliver(SweepNews{1, captured(1, 7), {}});
    EXPECT_THAT(received(client), ElementsAre("sweep 7"));
}

TEST_F(LocalHubTest, AFrameThatIsNotNewGoesToNewSubscribersOnly) {
    Client early(*this);
    ASSERT_TRUE(early.subscription.set_wish(Wish{}));
    auto news = sweep(1, "before");
    news.frames[0].is_new = false;
    hub.deliver(news);
    EXPECT_TRUE(received(early).empty());
    Client late(*this);
    ASSERT_TRUE(late.subscription.set_wish(Wish{}));
    EXPECT_THAT(received(late), ElementsAre("before zstd"));
}

TEST_F(LocalHubTest, SectorsGoToWhoWantsThemAndNoLatestSweepDoes) {
    Client client(*this);
    Client other(*this);
    Wish sectors;
    sectors.frames.kind = frame::Kind::sector;
    hub.deliver(SweepNews{1, captured(1, 7), {}});
    ASSERT_TRUE(client.subscription.set_wish(sectors));
    EXPECT_TRUE(received(client).empty());
    hub.deliver(SectorNews{1, frames(1, "sector")});
    ASSERT_TRUE(other.subscription.set_wish(Wish{}));
    EXPECT_THAT(received(client), ElementsAre("sector zstd"));
    EXPECT_THAT(received(other), ElementsAre("sweep 7"));
    hub.deliver(SweepNews{1, captured(1, 8), {}});  // all of it had been sent as sectors
    EXPECT_TRUE(received(client).empty());
}

TEST_F(LocalHubTest, AWishThatIsOneTooManyLeavesTheOneBefore) {
    const auto nth = [](std::uint32_t n) {
        Wish wish;
        wish.frames.every_nth = n;
        return wish;
    };
    Client client(*this);
    ASSERT_TRUE(client.subscription.set_wish(nth(2)));
    Client same(*this);
    ASSERT_TRUE(same.subscription.set_wish(nth(2)));
    std::vector<std::unique_ptr<Client>> others;
    for (std::uint32_t i = 1; i < Variants::most; ++i) {
        others.push_back(std::make_unique<Client>(*this));
        ASSERT_TRUE(others.back()->subscription.set_wish(nth(2 + i)));
    }
    EXPECT_FALSE(client.subscription.set_wish(nth(1000), message("answer")));
    EXPECT_TRUE(client.subscription.set_wish(nth(5)));
    // One whose wish nobody else has may change it.
    EXPECT_TRUE(same.subscription.set_wish(nth(1000)));
    EXPECT_FALSE(client.subscription.set_wish(nth(1001), message("answer")));
    hub.deliver(sweep(1, "sweep"));
    EXPECT_THAT(received(client), ElementsAre("sweep zstd"));
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

StateNews identified(
    std::uint32_t number,
    const std::string& id,
    const std::string& port_name,
    std::uint8_t last_of_serial = 0
) {
    auto lidar = std::make_shared<LidarSnapshot>();
    lidar->number = number;
    lidar->id = id;
    lidar->port_name = port_name;
    lidar->state.info = protocol::DeviceInfo{.serial = {0xA0, 0xE1, 0xC2, 0xD3}};
    lidar->state.info->serial.back() = last_of_serial;
    return {lidar, message("state of " + id)};
}

TEST_F(LocalHubTest, ANamedLidarIsFoundByItsSerialNumberToo) {
    hub.deliver(identified(1, "back", "ttyUSB0"));
    for (const auto* id : {"back", "A0E1C2D3", "A0E1C2D3000000000000000000000000", "ttyUSB0"}) {
        ASSERT_TRUE(hub.find(id)) << id;
        EXPECT_EQ(hub.find(id)->number, 1U) << id;
    }
    for (const auto* id : {"", "A0E1C2D", "A0E1C2D30", "E1C2D300"}) {
        EXPECT_FALSE(hub.find(id)) << id;
    }
}

TEST_F(LocalHubTest, FirstDigitsThatTwoNamedLidarsShareMeanNeither) {
    hub.deliver(identified(1, "back", "ttyUSB0", 1));
    hub.deliver(identified(2, "front", "ttyUSB1", 2));
    EXPECT_FALSE(hub.find("A0E1C2D3"));
    ASSERT_TRUE(hub.find("A0E1C2D3000000000000000000000002"));
    EXPECT_EQ(hub.find("A0E1C2D3000000000000000000000002")->number, 2U);
}

TEST_F(LocalHubTest, AnIdGoesBeforeASerialNumberAndAPort) {
    hub.deliver(identified(1, "back", "left"));
    hub.deliver(identified(2, "left", "ttyUSB1", 2));
    EXPECT_EQ(hub.find("left")->number, 2U);
    hub.deliver(identified(2, "A0E1C2D3", "ttyUSB1", 2));
    EXPECT_EQ(hub.find("A0E1C2D3")->number, 2U);
}

}  // namespace
}  // namespace sweepcast::hub
