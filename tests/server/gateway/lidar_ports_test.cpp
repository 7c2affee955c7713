// Which lidar belongs to which port, when they answer at others than theirs.
#include "server/gateway/lidar_ports.hpp"

#include "driver/virtual/virtual_lidar.hpp"
#include "tests/driver/link/scratch_directory.hpp"
#include "tests/support/process.hpp"

#include <boost/asio/post.hpp>
#include <gtest/gtest.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <array>
#include <chrono>
#include <future>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace sweepcast::gateway {
namespace {

class LidarPortsTest : public testing::Test {
protected:
    LidarPortsTest() {
        for (const std::uint32_t number : {1U, 2U}) {
            ports.add(number, port(number), [this, number] { ++moves.at(number - 1); });
        }
    }
    static std::string port(std::uint32_t number) { return "/dev/tty" + std::to_string(number); }
    bool answers(std::uint32_t number, const std::string& serial) {
        return ports.is_it(number, ports.path_of(number), serial);
    }

    LidarPorts ports{
        {},
        [](std::exception_ptr) { FAIL() << "a task failed"; },
        std::make_shared<spdlog::logger>("null", std::make_shared<spdlog::sinks::null_sink_mt>())};
    std::array<int, 2> moves{};
};

TEST_F(LidarPortsTest, TakeWhomeverTheyMeetFirst) {
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_TRUE(answers(2, "B"));
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_EQ(moves, (std::array{0, 0}));
}

TEST_F(LidarPortsTest, GiveALidarThatIsAtAnothersPortThatPort) {
    ASSERT_TRUE(answers(1, "A") && answers(2, "B"));
    ports.lost(1);
    ports.lost(2);
    EXPECT_FALSE(answers(1, "B"));
    EXPECT_EQ(ports.path_of(1), port(2));
    EXPECT_EQ(ports.path_of(2), port(1));
    EXPECT_EQ(moves, (std::array{1, 1}));
    EXPECT_FALSE(ports.is_it(2, port(2), "A")) << "told by the other one before";
    EXPECT_EQ(moves, (std::array{1, 1}));
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_TRUE(answers(2, "B"));
}

TEST_F(LidarPortsTest, GiveALidarThatCameToAPortOfNobodyYetThatPort) {
    ASSERT_TRUE(answers(2, "B"));
    ports.lost(2);
    EXPECT_FALSE(answers(1, "B"));
    EXPECT_EQ(ports.path_of(2), port(1));
}

TEST_F(LidarPortsTest, DoNotTakeAStrangerAtOnce) {
    ASSERT_TRUE(answers(1, "A"));
    ports.lost(1);
    EXPECT_FALSE(answers(1, "C"));
    EXPECT_FALSE(answers(1, "C"));
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_EQ(ports.path_of(1), port(1));
}

TEST_F(LidarPortsTest, ExpectALidarThatAnEarlierRunKnew) {
    ports.add(
        1,
        port(1),
        [] {},
        RememberedLidar{"A", 115200}
    );
    EXPECT_FALSE(answers(1, "C"));
    EXPECT_TRUE(answers(1, "A"));
}

TEST_F(LidarPortsTest, GiveALidarThatAnEarlierRunKnewThePortWhereItIs) {
    ports.add(
        1,
        port(1),
        [this] { ++moves.at(0); },
        RememberedLidar{"A", 115200}
    );
    EXPECT_FALSE(answers(2, "A"));
    EXPECT_EQ(ports.path_of(1), port(2));
    EXPECT_TRUE(answers(1, "A"));
    EXPECT_TRUE(answers(2, "B"));
}

TEST_F(LidarPortsTest, LeaveALidarInHandWhereItIsWhateverAnEarlierRunKnew) {
    ASSERT_TRUE(answers(2, "A"));
    ports.add(
        1,
        port(1),
        [this] { ++moves.at(0); },
        RememberedLidar{"A", 115200}
    );
    EXPECT_TRUE(answers(2, "A"));
    EXPECT_EQ(ports.path_of(2), port(2));
    EXPECT_EQ(moves, (std::array{0, 0}));
}

TEST_F(LidarPortsTest, LetAStandInBeWhoeverItSaysItIs) {
    ports.add_vacant(1, port(1), [this] { ++moves.at(0); });
    EXPECT_TRUE(answers(1, "V"));
    ASSERT_TRUE(answers(2, "B"));
    EXPECT_TRUE(answers(1, "W"));
    EXPECT_EQ(moves, (std::array{0, 0}));
}

TEST_F(LidarPortsTest, TellTwoLidarsOfOneSerialNumberApart) {
    ASSERT_TRUE(answers(1, "0"));
    EXPECT_TRUE(answers(2, "0")) << "the other one is in hand";
    ports.lost(2);
    EXPECT_TRUE(answers(2, "0"));
    EXPECT_EQ(moves, (std::array{0, 0}));
}

/// Virtual lidars on links in a folder; the ports are those that match it.
class LidarSearchTest : public testing::Test {
protected:
    ~LidarSearchTest() override {
        ports.reset();
        worker.stop();
        lidars.clear();
        if (HasFailure()) {
            std::cout << told.str();
        }
    }
    std::string path(const std::string& name) const { return (scratch.root() / name).string(); }
    void plug(const std::string& name, const std::string& serial) {
        virtual_lidar::VirtualLidarOptions options;
        options.link = path(name);
        options.serial = serial;
        auto created = virtual_lidar::VirtualLidar::create(worker.executor(), options, log);
        ASSERT_TRUE(created) << created.error().cause;
        auto& lidar = *lidars.emplace_back(std::move(*created));
        boost::asio::post(worker.executor(), [this, &lidar] { worker.tasks().spawn(lidar.run()); });
    }
    void start() {
        ports.emplace(
            std::vector{path("*")},
            [](std::exception_ptr) { FAIL() << "a task failed"; },
            log
        );
    }
    /// Lidar 1, at a port that is not there, is looked for.
    void seek(std::optional<RememberedLidar> remembered) {
        ports->add(
            1,
            path("gone"),
            [this] { moved.set_value(); },
            std::move(remembered)
        );
        ports->seek(1, 115200);
    }
    /// Lidar 1 is a stand-in.
    void wait_for_anybody() {
        ports->add_vacant(1, path("virtual"), [this] { moved.set_value(); });
    }
    std::string found_at() {
        const auto found = moved.get_future().wait_for(std::chrono::seconds(60));
        moved = {};
        return found == std::future_status::ready ? ports->path_of(1) : "nowhere";
    }

    static constexpr const char* ours = "A0A0A0A0000000000000000000000001";
    static constexpr const char* other = "B0B0B0B0000000000000000000000002";
    link::ScratchDirectory scratch;
    std::ostringstream told;
    std::shared_ptr<spdlog::logger> log = std::make_shared<spdlog::logger>(
        "test",
        std::make_shared<spdlog::sinks::ostream_sink_mt>(told)
    );
    async::Worker worker{"lidars", [](std::exception_ptr) { FAIL() << "a lidar failed"; }};
    std::vector<std::unique_ptr<virtual_lidar::VirtualLidar>> lidars;
    std::optional<LidarPorts> ports;
    std::promise<void> moved;
};

TEST_F(LidarSearchTest, FindsALidarOfAnEarlierRunAtAPortThatWasThereBefore) {
    plug("a stranger", other);
    plug("there", ours);
    start();
    seek(RememberedLidar{ours, 115200});
    EXPECT_EQ(found_at(), path("there"));
}

TEST_F(LidarSearchTest, FindsALidarOfAnEarlierRunAtAPortThatNewlyAppeared) {
    start();
    seek(RememberedLidar{ours, 115200});
    plug("new", ours);
    EXPECT_EQ(found_at(), path("new"));
}

TEST_F(LidarSearchTest, DoesNotAskAtPortsThatWereThereForALidarThatWasMetSince) {
    plug("there", ours);
    start();
    seek(std::nullopt);
    ASSERT_TRUE(ports->is_it(1, path("gone"), ours));
    ports->seek(1, 115200);
    plug("new", ours);
    EXPECT_EQ(found_at(), path("new"));
}

TEST_F(LidarSearchTest, DoesNotAskAtThePortOfAnotherLidar) {
    plug("there", ours);
    start();
    ports->add(2, path("there"), [] {});
    seek(RememberedLidar{ours, 115200});
    plug("new", ours);
    EXPECT_EQ(found_at(), path("new"));
}

TEST_F(LidarSearchTest, GivesAVacantPlaceToALidarThatNewlyAppeared) {
    start();
    wait_for_anybody();
    plug("new", ours);
    EXPECT_EQ(found_at(), path("new"));
    EXPECT_EQ(ports->baud_at_path(1), 115200U);
    EXPECT_TRUE(ports->is_it(1, path("new"), ours));
}

TEST_F(LidarSearchTest, GivesAVacantPlaceToALidarThatDidNotAnswerYetWhenAllWereAsked) {
    plug("there", ours);
    start();
    wait_for_anybody();
    EXPECT_EQ(found_at(), path("there"));
}

TEST_F(LidarSearchTest, GivesAVacantPlaceToAnotherIfTheFirstIsGoneBeforeItIsMet) {
    start();
    wait_for_anybody();
    plug("new", ours);
    ASSERT_EQ(found_at(), path("new"));
    ports->seek(1, 115200);
    plug("next", other);
    EXPECT_EQ(found_at(), path("next"));
    EXPECT_TRUE(ports->is_it(1, path("next"), other));
}

TEST_F(LidarSearchTest, DoesNotGiveAVacantPlaceToALidarOfAnotherPlace) {
    start();
    ports->add(2, path("gone"), [] {});
    ASSERT_TRUE(ports->is_it(2, path("gone"), ours));
    wait_for_anybody();
    plug("elsewhere", ours);
    plug("new", other);
    EXPECT_EQ(found_at(), path("new"));
}

TEST_F(LidarSearchTest, LeavesAPortAloneThatSomebodyHasOpen) {
    plug("in use", ours);
    // Another process: the one that plays the lidar may have its port open.
    test::Process user(
        {"/bin/sh", "-c", R"(exec 3<>"$1"; echo open; exec sleep 1000)", "sh", path("in use")}
    );
    user.wait_for_output("open");
    start();
    wait_for_anybody();
    plug("new", other);
    EXPECT_EQ(found_at(), path("new"));
}

}  // namespace
}  // namespace sweepcast::gateway
