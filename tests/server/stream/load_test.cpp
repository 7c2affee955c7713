// Everything at once, where threads meet: four workers, several publishers, clients that come, go,
// change their minds and stop reading, and the end while all of that goes on. Worth most under
// ThreadSanitizer.
#include "driver/async/notifier.hpp"
#include "driver/async/worker.hpp"
#include "server/frame/message_framing.hpp"
#include "server/hub/hub.hpp"
#include "server/hub/lidar_frames.hpp"
#include "server/stream/messages.hpp"
#include "server/stream/session.hpp"
#include "server/stream/tcp_transport.hpp"
#include "sweepcast/v1/stream.pb.h"
#include "tests/server/hub/socket_pair.hpp"
#include "tests/server/stream/known_lidar.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace sweepcast::stream {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;

constexpr std::size_t worker_count = 4;
constexpr std::uint32_t lidar_count = 3;
constexpr int client_count = 24;
constexpr int visits_before_the_end = 100;
constexpr std::uint64_t frames_between_ticks = 50;

device::CapturedSweep sweep_of(std::uint32_t lidar, std::uint64_t sequence) {
    device::CapturedSweep captured;
    captured.lidar = std::to_string(lidar);
    captured.lidar_number = lidar;
    captured.sequence = sequence;
    captured.sweep.samples.resize(300);
    for (auto& sample : captured.sweep.samples) {
        sample.distance.raw =
            4000 + static_cast<std::uint32_t>(&sample - captured.sweep.samples.data());
    }
    return captured;
}

/// What one client has of its stream; tells what is wrong with it.
class Reader {
public:
    explicit Reader(tcp::socket socket) : socket_(std::move(socket)) {}

    /// Reads so many frames; false once the stream has ended.
    asio::awaitable<bool> read(int frames) {
        std::array<std::uint8_t, 4096> chunk{};
        const auto space = asio::buffer(chunk);
        while (frames > 0) {
            const auto [ended, got] =
                co_await socket_.async_read_some(space, asio::as_tuple(asio::use_awaitable));
            if (ended) {
                co_return false;
            }
            reader_.push(std::span(chunk).first(got));
            auto next = reader_.next();
            for (; next && *next; next = reader_.next()) {
                frames -= take(**next) ? 1 : 0;
            }
            EXPECT_TRUE(next) << "the stream is garbled";
        }
        co_return true;
    }

    asio::awaitable<void> subscribe(const std::string& lidar, v1::Compression compression) {
        v1::ClientMessage message;
        message.mutable_subscribe()->set_lidar(lidar);
        message.mutable_subscribe()->set_compression(compression);
        const auto text = message.SerializeAsString();
        std::vector<std::uint8_t> bytes;
        frame::append_delimited(bytes, std::vector<std::uint8_t>(text.begin(), text.end()));
        const auto whole = asio::buffer(bytes);
        // A stream that ends meanwhile is seen by who reads.
        (void)co_await asio::async_write(socket_, whole, asio::as_tuple(asio::use_awaitable));
    }

private:
    /// Whether it is a frame.
    bool take(std::span<const std::uint8_t> bytes) {
        v1::ServerMessage message;
        EXPECT_TRUE(message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
        if (!message.has_frame()) {
            return false;
        }
        auto& last = last_[message.frame().lidar()];
        EXPECT_GE(message.frame().sequence(), last) << "a frame came too late";
        last = message.frame().sequence();
        return true;
    }

    tcp::socket socket_;
    frame::DelimitedReader reader_{1U << 20U};
    std::map<std::string, std::uint64_t> last_;
};

class LoadTest : public testing::Test {
protected:
    LoadTest() {
        std::vector<hub::Hub::Executor> executors;
        for (std::size_t i = 0; i < worker_count; ++i) {
            workers_.push_back(std::make_unique<async::Worker>("test", [](std::exception_ptr) {
                ADD_FAILURE() << "a session failed";
            }));
            executors.push_back(workers_.back()->executor());
        }
        hub_ = std::make_unique<hub::Hub>(executors);
        for (std::uint32_t lidar = 1; lidar <= lidar_count; ++lidar) {
            publish_state(lidar);
        }
    }
    ~LoadTest() override { workers_.clear(); }

    void publish_state(std::uint32_t number) {
        auto lidar = std::make_shared<hub::LidarSnapshot>(*known_lidar());
        lidar->number = number;
        lidar->id = std::to_string(number);
        lidar->port_name = "port" + lidar->id;
        const auto message = state_message(*lidar);
        hub_->publish(hub::StateNews{std::move(lidar), message});
    }

    /// One lidar's thread: sweeps, and a change of state now and then.
    void publish_until_the_end(std::uint32_t lidar) {
        hub::LidarFrames frames(hub_->variants(), lidar);
        for (std::uint64_t sequence = 1; !ends_; ++sequence) {
            auto sweep = sweep_of(lidar, sequence);
            auto made = frames.of(sweep);
            auto shared = std::make_shared<const device::CapturedSweep>(std::move(sweep));
            hub_->publish(hub::SweepNews{lidar, std::move(shared), std::move(made)});
            if (sequence % frames_between_ticks == 0) {
                publish_state(lidar);
                asio::post(clients_, [this] { tick_.notify(); });
            }
            std::this_thread::yield();
        }
    }

    asio::awaitable<void> serve(tcp::socket socket, std::size_t worker) {
        SessionSettings settings{"test", std::nullopt, {.frames = 4}};
        const auto transport = make_tcp_transport(std::move(socket));
        co_await serve_subscriber(*transport, hub_->local(worker), std::move(settings), log_);
    }

    /// The client's end of a new connection.
    tcp::socket connect(std::size_t worker) {
        auto& serving = *workers_[worker];
        auto [mine, its] = hub::socket_pair(clients_.get_executor(), serving.executor());
        auto handed = std::make_shared<tcp::socket>(std::move(its));
        asio::post(serving.executor(), [this, &serving, worker, handed] {
            if (ends_) {
                handed->close();
            } else {
                serving.tasks().spawn(serve(std::move(*handed), worker));
            }
        });
        return std::move(mine);
    }

    /// Comes and goes until the gateway ends.
    asio::awaitable<void> be_a_client(unsigned number) {
        std::mt19937 random(number);  // NOLINT(cert-msc51-cpp): the same in every run
        for (bool goes_on = true; goes_on && !ends_;) {
            Reader reader(connect(random() % worker_count));
            for (int wish = 0; goes_on && wish < 3; ++wish) {
                const auto lidar = random() % (lidar_count + 1);
                const auto name = lidar == 0 ? std::string() : std::to_string(lidar);
                co_await reader.subscribe(name, random() % 2 == 0 ? v1::ZSTD : v1::NONE);
                goes_on = co_await reader.read(5);
                for (auto ticks = random() % 3; goes_on && !ends_ && ticks > 0; --ticks) {
                    co_await tick_.wait_until(std::chrono::steady_clock::now() + 20s);
                }
                if (goes_on) {
                    goes_on = co_await reader.read(20);
                }
            }
            if (++visits_ == visits_before_the_end) {
                busy_enough_.set_value();
            }
        }
    }

    /// As the gateway does it. Whether all sessions ended in time.
    static asio::awaitable<bool> end_sessions(async::Worker& worker, hub::LocalHub& hub) {
        hub.close_all(closing_message("the end"), "the end");
        const bool ended = co_await worker.tasks().join(200ms);
        if (ended) {
            co_return true;
        }
        worker.tasks().cancel();
        co_return co_await worker.tasks().join(20s);
    }

    asio::io_context clients_;
    async::Notifier tick_{clients_.get_executor()};
    std::vector<std::unique_ptr<async::Worker>> workers_;
    std::unique_ptr<hub::Hub> hub_;
    std::shared_ptr<spdlog::logger> log_ = std::make_shared<spdlog::logger>("test");
    std::atomic<bool> ends_{};
    std::atomic<int> visits_{};
    std::promise<void> busy_enough_;
};

TEST_F(LoadTest, NothingBreaksWhileClientsComeAndGoAndTheGatewayEnds) {
    std::vector<std::future<void>> clients;
    for (unsigned i = 0; i < client_count; ++i) {
        clients.push_back(asio::co_spawn(clients_, be_a_client(i), asio::use_future));
    }
    std::vector<std::thread> publishers;
    for (std::uint32_t lidar = 1; lidar <= lidar_count; ++lidar) {
        publishers.emplace_back([this, lidar] { publish_until_the_end(lidar); });
    }
    std::thread reading([this] { clients_.run(); });

    EXPECT_EQ(busy_enough_.get_future().wait_for(100s), std::future_status::ready);
    std::vector<std::future<bool>> ends;
    for (std::size_t i = 0; i < worker_count; ++i) {
        ends.push_back(asio::co_spawn(
            workers_[i]->executor(),
            end_sessions(*workers_[i], hub_->local(i)),
            asio::use_future
        ));
    }
    ends_ = true;
    asio::post(clients_, [this] { tick_.notify(); });
    for (auto& end : ends) {
        EXPECT_TRUE(end.get()) << "sessions did not end";
    }
    for (auto& publisher : publishers) {
        publisher.join();
    }
    for (auto& client : clients) {
        EXPECT_EQ(client.wait_for(20s), std::future_status::ready) << "a client was not let go";
    }
    clients_.stop();
    reading.join();
    for (auto& worker : workers_) {
        worker->stop();
    }
    EXPECT_EQ(hub_->local(0).subscribers(), 0U);
}

}  // namespace
}  // namespace sweepcast::stream
