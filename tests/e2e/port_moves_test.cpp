// Lidars that are pulled out and come back: on the same port, on another one, on each other's.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;

constexpr const char* serial_a = "A0A0A0A0000000000000000000000001";
constexpr const char* serial_b = "B0B0B0B0000000000000000000000002";

class PortMoves : public testing::Test {
protected:
    /// Destroyed, it is pulled out: its port goes, and the link with it, as udev does it. The link
    /// goes first: once the port is gone, its number may be another program's terminal.
    class Lidar {
    public:
        Lidar(const std::string& link, const std::string& serial, const std::string& model)
            : link_(link)
            , process_(std::make_unique<VirtualLidarProcess>(
                  std::vector<std::string>{"--link", link, "--serial", serial, "--model", model}
              )) {}
        ~Lidar() {
            std::error_code ignored;
            std::filesystem::remove(link_, ignored);
            process_.reset();  // killed
        }
        Lidar(const Lidar&) = delete;
        Lidar& operator=(const Lidar&) = delete;

    private:
        std::string link_;
        std::unique_ptr<VirtualLidarProcess> process_;
    };

    std::unique_ptr<Lidar>
    plug(const std::string& link, const std::string& serial, const std::string& model = "a1m8") {
        return std::make_unique<Lidar>(scratch.file(link), serial, model);
    }
    /// Has a gateway know the lidar that is at that port, where its user names it.
    void meet_in_an_earlier_run(const std::string& link) {
        GatewayProcess gateway({"--lidar", scratch.file(link), "--state-dir", scratch.file("state")}
        );
        Subscriber client("tcp://" + gateway.tcp);
        client.wait_for_state(v1::Lidar::SCANNING);
    }
    /// Waits until the lidar of that id scans at that port.
    static v1::Lidar wait_for(Subscriber& client, const std::string& id, const std::string& url) {
        return client.wait_for_lidar([&](const auto& lidar) {
            return lidar.id() == id && lidar.url() == url && lidar.state() == v1::Lidar::SCANNING;
        });
    }

    /// Waits until so many lidars have been seen scanning; returns the URL of each by its id.
    static std::map<std::string, std::string>
    scanning_lidars(Subscriber& client, std::size_t count) {
        std::map<std::string, std::string> urls;
        client.next([&](const auto& message) {
            for (const auto& lidar : lidars_in(message)) {
                if (lidar.state() == v1::Lidar::SCANNING) {
                    urls[lidar.id()] = lidar.url();
                }
            }
            return urls.size() >= count;
        });
        return urls;
    }

    ScratchDirectory scratch;
};

TEST_F(PortMoves, ALidarThatComesBackOnItsPortGoesOn) {
    auto lidar = plug("one", serial_a);
    GatewayProcess gateway({"--lidar", scratch.file("one")});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    wait_for(client, "A0A0A0A0", scratch.file("one"));
    const auto before = client.next_sweep().sequence;
    lidar.reset();
    client.next([](const auto& message) {
        return message.has_lidar() && message.lidar().state() != v1::Lidar::SCANNING;
    });
    lidar = plug("one", serial_a);
    wait_for(client, "A0A0A0A0", scratch.file("one"));
    EXPECT_GT(client.next_sweep().sequence, before);
}

TEST_F(PortMoves, ALidarThatComesBackOnAnotherPortIsFoundThere) {
    auto lidar = plug("one", serial_a);
    GatewayProcess gateway(
        {"--lidar", scratch.file("one") + "?name=front", "--discover", scratch.file("*")}
    );
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    wait_for(client, "front", scratch.file("one") + "?name=front");
    const auto before = client.next_sweep().sequence;
    lidar.reset();
    const auto stranger = plug("two", serial_b);
    lidar = plug("three", serial_a);
    const auto found = wait_for(client, "front", scratch.file("three") + "?name=front");
    EXPECT_EQ(found.device().serial_number(), serial_a);
    const auto after = client.next_sweep();
    EXPECT_GT(after.sequence, before);
    EXPECT_EQ(after.lidar, "front");
}

TEST_F(PortMoves, LidarsThatSwapTheirPortsKeepTheirNames) {
    auto a = plug("one", serial_a);
    auto b = plug("two", serial_b);
    GatewayProcess gateway(
        {"--lidar", scratch.file("one"), "--lidar", scratch.file("two") + "?name=back"}
    );
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto scanning = scanning_lidars(client, 2);
    EXPECT_THAT(scanning, testing::ElementsAre(testing::Key("A0A0A0A0"), testing::Key("back")));
    a.reset();
    b.reset();
    b = plug("one", serial_b);
    a = plug("two", serial_a);
    std::vector<v1::Lidar> moved;
    while (moved.size() < 2) {
        moved.push_back(client
                            .next([&](const auto& message) {
                                const auto& lidar = message.lidar();
                                return lidar.state() == v1::Lidar::SCANNING &&
                                       lidar.url() != scratch.file("one") &&
                                       lidar.url() != scratch.file("two") + "?name=back" &&
                                       (moved.empty() || moved.front().id() != lidar.id());
                            })
                            .lidar());
    }
    for (const auto& lidar : moved) {
        const bool is_a = lidar.id() == "A0A0A0A0";
        EXPECT_EQ(lidar.device().serial_number(), is_a ? serial_a : serial_b);
        EXPECT_EQ(lidar.url(), is_a ? scratch.file("two") : scratch.file("one") + "?name=back");
    }
}

TEST_F(PortMoves, AnotherLidarTakesThePlaceOfOneThatIsNowhere) {
    auto lidar = plug("one", serial_a);
    GatewayProcess gateway({"--lidar", scratch.file("one")});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    wait_for(client, "A0A0A0A0", scratch.file("one"));
    lidar.reset();
    lidar = plug("one", serial_b);
    gateway.process.wait_for_log("lidar B0B0B0B0 is there, and not A0A0A0A0");
    gateway.process.wait_for_log("lidar B0B0B0B0 takes the place of A0A0A0A0");
    wait_for(client, "B0B0B0B0", scratch.file("one"));
}

TEST_F(PortMoves, AnotherLidarOnThePortDoesNotTakeThePlaceOfOneThatIsElsewhere) {
    auto lidar = plug("one", serial_a);
    GatewayProcess gateway({"--lidar", scratch.file("one"), "--discover", scratch.file("*")});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    wait_for(client, "A0A0A0A0", scratch.file("one"));
    lidar.reset();
    const auto stranger = plug("one", serial_b);
    lidar = plug("two", serial_a);
    wait_for(client, "A0A0A0A0", scratch.file("two"));
}

TEST_F(PortMoves, ALidarThatMovedWhileTheGatewayWasOffIsFoundByItsSerialNumber) {
    auto lidar = plug("one", serial_a);
    meet_in_an_earlier_run("one");
    lidar.reset();
    const auto stranger = plug("two", serial_b);
    lidar = plug("three", serial_a);
    GatewayProcess gateway(
        {"--lidar",
         scratch.file("one") + "?name=front",
         "--discover",
         scratch.file("t*"),
         "--state-dir",
         scratch.file("state")}
    );
    EXPECT_EQ(Subscriber("tcp://" + gateway.tcp).next().hello().lidars_size(), 2)
        << "it is not there twice";
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    wait_for(client, "front", scratch.file("three") + "?name=front");
}

TEST_F(PortMoves, ALidarThatMovedWhileTheGatewayWasOffGetsItsOwnPortBackWhenItReturns) {
    auto lidar = plug("one", serial_a);
    meet_in_an_earlier_run("one");
    lidar.reset();
    GatewayProcess gateway({"--lidar", scratch.file("one"), "--state-dir", scratch.file("state")});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    lidar = plug("one", serial_a);
    wait_for(client, "A0A0A0A0", scratch.file("one"));
}

TEST_F(PortMoves, AnotherLidarOnItsPortIsNotTakenForOneThatMovedWhileTheGatewayWasOff) {
    auto lidar = plug("one", serial_a);
    meet_in_an_earlier_run("one");
    lidar.reset();
    const auto stranger = plug("one", serial_b);
    lidar = plug("two", serial_a);
    GatewayProcess gateway(
        {"--lidar",
         scratch.file("one") + "?name=front",
         "--discover",
         scratch.file("two"),
         "--state-dir",
         scratch.file("state")}
    );
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    EXPECT_THAT(
        scanning_lidars(client, 2),
        testing::ElementsAre(
            testing::Pair("B0B0B0B0", scratch.file("one")),
            testing::Pair("front", scratch.file("two") + "?name=front")
        )
    );
}

TEST_F(PortMoves, AnotherLidarTakesThePlaceOfOneThatIsNowhereSinceTheGatewayWasOff) {
    auto lidar = plug("one", serial_a);
    meet_in_an_earlier_run("one");
    lidar.reset();
    lidar = plug("one", serial_b);
    GatewayProcess gateway({"--lidar", scratch.file("one"), "--state-dir", scratch.file("state")});
    gateway.process.wait_for_log("lidar B0B0B0B0 is there, and not A0A0A0A0");
    gateway.process.wait_for_log("lidar B0B0B0B0 takes the place of A0A0A0A0");
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    client.wait_for_state(v1::Lidar::SCANNING);
}

TEST_F(PortMoves, ALidarThatIsPluggedInTakesThePlaceOfTheVirtualOne) {
    GatewayProcess gateway({"--discover", scratch.file("*"), "--log-level", "debug"});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto stand_in = client.wait_for_state(v1::Lidar::SCANNING);
    EXPECT_TRUE(stand_in.is_virtual() && stand_in.is_stand_in());
    const auto before = client.next_sweep().sequence;
    const auto lidar = plug("new", serial_a, "s2");
    const auto real = wait_for(client, "A0A0A0A0", scratch.file("new"));
    EXPECT_FALSE(real.is_virtual() || real.is_stand_in());
    EXPECT_EQ(real.device().serial_number(), serial_a);
    const auto after = client.next_sweep();
    EXPECT_GT(after.sequence, before);
    EXPECT_EQ(after.lidar, "A0A0A0A0");
    const auto told = http(gateway.http, "GET", "/api/v1/lidars/A0A0A0A0").body;
    EXPECT_THAT(told, HasSubstr(scratch.file("new")));
    EXPECT_THAT(told, testing::ContainsRegex("\"is_virtual\": ?false"));
    EXPECT_THAT(told, testing::ContainsRegex("\"is_stand_in\": ?false"));
    gateway.process.signal(SIGTERM);
    EXPECT_EQ(gateway.process.wait(), 0);
    const auto log = gateway.process.rest_of_log();
    EXPECT_THAT(
        log,
        HasSubstr(
            "lidar A0A0A0A0 at " + scratch.file("new") + " takes the place of the virtual one"
        )
    );
    EXPECT_THAT(log, testing::ContainsRegex("virtual-a1m8\\] /dev/pts/[0-9]+ stopped"));
    EXPECT_THAT(log, HasSubstr("looking for it at 1000000, 115200"));
    EXPECT_THAT(log, testing::Not(HasSubstr("the device is gone"))) << "it was not lost";
}

TEST_F(PortMoves, OnlyOneLidarTakesThePlaceOfTheVirtualOneAndKeepsIt) {
    GatewayProcess gateway({"--discover", scratch.file("*")});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    auto lidar = plug("one", serial_a);
    wait_for(client, "A0A0A0A0", scratch.file("one"));
    const auto second = plug("two", serial_b);
    lidar.reset();
    client.next([](const auto& message) {
        return message.has_lidar() && message.lidar().state() != v1::Lidar::SCANNING;
    });
    lidar = plug("three", serial_a);
    wait_for(client, "A0A0A0A0", scratch.file("three"));
    Subscriber next("tcp://" + gateway.tcp);
    EXPECT_EQ(next.next().hello().lidars_size(), 1);
}

}  // namespace
}  // namespace sweepcast::test
