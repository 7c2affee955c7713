// Api: routes, answers and refusals, without a socket.
#include "server/api/api.hpp"

#include "driver/device/advice.hpp"
#include "driver/device/error.hpp"
#include "server/frame/dictionary.hpp"
#include "server/stream/messages.hpp"
#include "sweepcast/v1/api.pb.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace sweepcast::api {
namespace {

namespace asio = boost::asio;
using testing::ElementsAre;
using testing::HasSubstr;

/// Writes down what it is told, and does it or not.
class RecordingControl final : public LidarControl {
public:
    asio::awaitable<Outcome> start(std::uint32_t lidar, std::string mode) override {
        co_return note("start " + std::to_string(lidar) + " " + mode);
    }
    asio::awaitable<Outcome> stop(std::uint32_t lidar) override {
        co_return note("stop " + std::to_string(lidar));
    }
    asio::awaitable<Outcome> reset(std::uint32_t lidar) override {
        co_return note("reset " + std::to_string(lidar));
    }

    asio::awaitable<Outcome> update(std::uint32_t lidar, LidarUpdate update) override {
        co_return note(
            "update " + std::to_string(lidar) + " mode " + update.mode.value_or("-") + " speed " +
            (update.speed_hz ? std::to_string(*update.speed_hz) : "-")
        );
    }

    asio::awaitable<Result<device::Diagnosis, Problem>> diagnose(std::uint32_t lidar) override {
        orders.push_back("diagnose " + std::to_string(lidar));
        if (problem) {
            co_return *problem;
        }
        device::Diagnosis diagnosis;
        diagnosis.port = "/dev/ttyUSB0";
        diagnosis.checks = {
            {"port", "The port exists", device::Verdict::ok, "CP2102"},
            {"open", "It opens", device::Verdict::failed, "no"},
            {"bytes", "It is heard", device::Verdict::not_run, ""}};
        diagnosis.cause = "it does not open";
        diagnosis.likely_causes = {"rust"};
        diagnosis.next_steps = {"oil", "wait"};
        co_return diagnosis;
    }

    Outcome note(const std::string& order) {
        orders.push_back(order);
        if (problem) {
            return *problem;
        }
        return Obeyed{snapshot, pending};
    }

    std::vector<std::string> orders;
    hub::LidarSnapshotPtr snapshot;
    bool pending{};
    std::optional<Problem> problem;
};

class ApiTest : public testing::Test {
protected:
    ApiTest() {
        auto lidar = std::make_shared<hub::LidarSnapshot>();
        lidar->number = 1;
        lidar->id = "A0E1C2D3";
        lidar->port_name = "ttyUSB0";
        lidar->state.phase = device::Phase::scanning;
        control.snapshot = lidar;
        hub.deliver(hub::StateNews{lidar, stream::state_message(*lidar)});
    }

    Response ask(
        const std::string& method,
        const std::string& target,
        const std::string& body = "",
        const std::string& accept = ""
    ) {
        Request request;
        request.method = method;
        request.body = body;
        request.accept = accept;
        EXPECT_TRUE(set_target(request, target));
        auto answered = asio::co_spawn(context, api.handle(std::move(request)), asio::use_future);
        context.restart();
        context.run();
        return answered.get();
    }

    /// A sweep that ended so long ago.
    void publish_sweep(std::chrono::milliseconds age = {}) {
        auto sweep = std::make_shared<device::CapturedSweep>();
        sweep->lidar = "A0E1C2D3";
        sweep->sequence = 9;
        sweep->sweep.samples.resize(3);
        for (auto& sample : sweep->sweep.samples) {
            sample.time = std::chrono::floor<std::chrono::microseconds>(
                std::chrono::steady_clock::now() - age
            );
        }
        hub.deliver(hub::SweepNews{.lidar = 1, .sweep = sweep, .frames = {}});
    }

    void publish_phase(device::Phase phase) {
        auto lidar = std::make_shared<hub::LidarSnapshot>(*control.snapshot);
        lidar->state.phase = phase;
        hub.deliver(hub::StateNews{lidar, stream::state_message(*lidar)});
    }

    static std::string header_of(const Response& response, std::string_view name) {
        const auto found =
            std::ranges::find(response.headers, name, &std::pair<std::string, std::string>::first);
        return found != response.headers.end() ? found->second : "";
    }

    static v1::Error error_in(const Response& response) {
        v1::ErrorResponse message;
        EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(response.body, &message).ok())
            << response.body;
        return message.error();
    }

    asio::io_context context;
    hub::Variants variants;
    hub::LocalHub hub{variants};
    RecordingControl control;
    Api api{hub, control};
};

TEST_F(ApiTest, GivesTheDictionaryThatFramesMayBeMadeWith) {
    const auto path = "/api/v1/dictionaries/" + std::to_string(frame::dictionary_id());
    const auto response = ask("GET", path);
    EXPECT_EQ(response.status, 200);
    EXPECT_EQ(response.content_type, "application/zstd-dictionary");
    const auto bytes = frame::dictionary_bytes();
    EXPECT_EQ(response.body, std::string(bytes.begin(), bytes.end()));
    EXPECT_EQ(ask("GET", path + "1").status, 404);
    EXPECT_EQ(ask("DELETE", path).status, 405);
}

TEST_F(ApiTest, PatchChangesWhatIsGiven) {
    EXPECT_EQ(ask("PATCH", "/api/v1/lidars/A0E1C2D3", R"({"speed_hz": 7})").status, 200);
    EXPECT_EQ(ask("PATCH", "/api/v1/lidars/A0E1C2D3", R"({"mode": "2"})").status, 200);
    EXPECT_EQ(
        ask("PATCH", "/api/v1/lidars/A0E1C2D3", R"({"mode": "Boost", "speedHz": 0})").status,
        200
    );
    EXPECT_THAT(
        control.orders,
        ElementsAre(
            "update 1 mode - speed 7.000000",
            "update 1 mode 2 speed -",
            "update 1 mode Boost speed 0.000000"
        )
    );
}

TEST_F(ApiTest, APatchThatSaysNothingIsRefused) {
    for (const auto* const body : {"", "{}", "[]", R"({"speed": 7})", R"({"speed_hz": "fast"})"}) {
        const auto response = ask("PATCH", "/api/v1/lidars/A0E1C2D3", body);
        EXPECT_EQ(response.status, 400) << body;
        EXPECT_EQ(error_in(response).code(), "bad_body") << body;
        EXPECT_THAT(error_in(response).hint(), HasSubstr("speed_hz"));
    }
    EXPECT_TRUE(control.orders.empty());
}

TEST_F(ApiTest, APatchOfASpeedThatCannotBeIsRefusedAsTheDeviceSays) {
    control.problem = Problem{make_error_code(device::errc::fixed_speed), "it cannot", "do not"};
    const auto fixed = ask("PATCH", "/api/v1/lidars/A0E1C2D3", R"({"speed_hz": 7})");
    EXPECT_EQ(fixed.status, 409);
    EXPECT_EQ(error_in(fixed).code(), "fixed_speed");
    control.problem->code = make_error_code(device::errc::no_such_speed);
    const auto beyond = ask("PATCH", "/api/v1/lidars/A0E1C2D3", R"({"speed_hz": 70})");
    EXPECT_EQ(beyond.status, 400);
    EXPECT_EQ(error_in(beyond).code(), "no_such_speed");
}

TEST_F(ApiTest, ListsTheLidars) {
    const auto response = ask("GET", "/api/v1/lidars");
    EXPECT_EQ(response.status, 200);
    v1::ListLidarsResponse message;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(response.body, &message).ok());
    ASSERT_EQ(message.lidars_size(), 1);
    EXPECT_EQ(message.lidars(0).id(), "A0E1C2D3");
    EXPECT_THAT(response.body, HasSubstr("\"SCANNING\""));
}

TEST_F(ApiTest, GivesOneLidarByIdOrPortName) {
    EXPECT_EQ(ask("GET", "/api/v1/lidars/A0E1C2D3").status, 200);
    EXPECT_EQ(
        ask("GET", "/api/v1/lidars/ttyUSB0").body,
        ask("GET", "/api/v1/lidars/A0E1C2D3").body
    );
}

TEST_F(ApiTest, HasLidarsObey) {
    EXPECT_EQ(ask("POST", "/api/v1/lidars/A0E1C2D3/start").status, 200);
    EXPECT_EQ(ask("POST", "/api/v1/lidars/A0E1C2D3/start", R"({"mode": "Express"})").status, 200);
    EXPECT_EQ(ask("POST", "/api/v1/lidars/A0E1C2D3/stop").status, 200);
    EXPECT_EQ(ask("POST", "/api/v1/lidars/A0E1C2D3/reset").status, 200);
    EXPECT_THAT(control.orders, ElementsAre("start 1 ", "start 1 Express", "stop 1", "reset 1"));
}

TEST_F(ApiTest, ACommandThatTheLidarWillObeyLaterIsAccepted) {
    control.pending = true;
    for (const auto* const action : {"start", "stop", "reset"}) {
        const auto response = ask("POST", std::string("/api/v1/lidars/A0E1C2D3/") + action);
        EXPECT_EQ(response.status, 202) << action;
        EXPECT_EQ(response.body, ask("GET", "/api/v1/lidars/A0E1C2D3").body);
    }
    EXPECT_EQ(ask("PATCH", "/api/v1/lidars/A0E1C2D3", R"({"speed_hz": 7})").status, 202);
}

TEST_F(ApiTest, TakesTheIdOfAModeAsANumber) {
    EXPECT_EQ(ask("PATCH", "/api/v1/lidars/A0E1C2D3", R"({"mode": 0})").status, 200);
    EXPECT_EQ(ask("POST", "/api/v1/lidars/A0E1C2D3/start", R"({"mode": 3})").status, 200);
    EXPECT_THAT(control.orders, ElementsAre("update 1 mode 0 speed -", "start 1 3"));
}

struct Refused {
    std::string method, target, body;
    int status;
    std::string code;
};

void PrintTo(const Refused& refused, std::ostream* out) {
    *out << refused.method << ' ' << refused.target << ' ' << refused.body;
}

class RefusedTest : public ApiTest, public testing::WithParamInterface<Refused> {};

TEST_P(RefusedTest, HasTheErrorShapeAndMovesNothing) {
    const auto& refused = GetParam();
    const auto response = ask(refused.method, refused.target, refused.body);
    EXPECT_EQ(response.status, refused.status);
    EXPECT_EQ(response.content_type, "application/json");
    const auto error = error_in(response);
    EXPECT_EQ(error.code(), refused.code);
    EXPECT_NE(error.message(), "");
    EXPECT_NE(error.hint(), "");
    EXPECT_TRUE(control.orders.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Requests,
    RefusedTest,
    testing::Values(
        Refused{"GET", "/nothing", "", 404, "not_found"},
        Refused{"GET", "/api/v1/lidars/", "", 404, "not_found"},
        Refused{"GET", "/api/v1/lidars/nobody", "", 404, "lidar_not_found"},
        Refused{"GET", "/api/v1/lidars/nobody/scan", "", 404, "lidar_not_found"},
        Refused{"POST", "/api/v1/lidars/nobody/start", "", 404, "lidar_not_found"},
        Refused{"POST", "/api/v1/lidars/nobody/stop", "", 404, "lidar_not_found"},
        Refused{"POST", "/api/v1/lidars/nobody/reset", "", 404, "lidar_not_found"},
        Refused{"POST", "/api/v1/lidars/a/b/stop", "", 404, "not_found"},
        Refused{"GET", "/api/v1/lidars/A0E1C2D3/start", "", 405, "method_not_allowed"},
        Refused{"DELETE", "/api/v1/lidars", "", 405, "method_not_allowed"},
        Refused{"POST", "/api/v1/lidars/A0E1C2D3/start", "mode=Express", 400, "bad_body"},
        Refused{"POST", "/api/v1/lidars/A0E1C2D3/start", R"({"mood": "Express"})", 400, "bad_body"},
        Refused{"POST", "/api/v1/lidars/A0E1C2D3/start", R"({"mode": 0.5})", 400, "bad_body"},
        Refused{"GET", "/api/v1/lidars/nobody/diagnosis", "", 404, "lidar_not_found"},
        Refused{"POST", "/api/v1/lidars/A0E1C2D3/diagnosis", "", 405, "method_not_allowed"},
        Refused{"GET", "/api/v1/lidars/A0E1C2D3/scan", "", 404, "no_scan_yet"},
        Refused{"GET", "/api/v1/lidars/A0E1C2D3/scan?format=xml", "", 400, "unknown_format"}
    )
);

TEST_F(ApiTest, SaysWhichMethodsAPathTakes) {
    const auto response = ask("GET", "/api/v1/lidars/A0E1C2D3/stop");
    EXPECT_THAT(response.headers, ElementsAre(testing::Pair("Allow", "POST")));
}

TEST_F(ApiTest, WhereGetIsAllowedSoIsHead) {
    const auto response = ask("DELETE", "/api/v1/lidars");
    EXPECT_EQ(response.status, 405);
    EXPECT_THAT(response.headers, ElementsAre(testing::Pair("Allow", "GET, HEAD")));
}

struct Mapped {
    device::errc code;
    int status;
    std::string name;
};

TEST_F(ApiTest, TurnsALidarsProblemsIntoStatusAndCode) {
    for (const auto& [code, status, name] : {
             Mapped{device::errc::unknown_mode, 400, "unknown_mode"},
             Mapped{device::errc::superseded, 409, "superseded"},
             Mapped{device::errc::not_ready, 503, "lidar_not_ready"},
             Mapped{device::errc::shutting_down, 503, "shutting_down"},
             Mapped{device::errc::no_answer, 503, "lidar_failed"},
         }) {
        control.problem = device::advice(code);
        const auto response = ask("POST", "/api/v1/lidars/A0E1C2D3/start");
        EXPECT_EQ(response.status, status);
        EXPECT_EQ(error_in(response).code(), name);
    }
}

TEST_F(ApiTest, GivesTheDiagnosisAsJson) {
    const auto response = ask("GET", "/api/v1/lidars/A0E1C2D3/diagnosis");
    EXPECT_EQ(response.status, 200);
    EXPECT_THAT(control.orders, ElementsAre("diagnose 1"));
    v1::Diagnosis diagnosis;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(response.body, &diagnosis).ok());
    EXPECT_EQ(diagnosis.port(), "/dev/ttyUSB0");
    EXPECT_EQ(diagnosis.verdict(), v1::Diagnosis::FAILED);
    ASSERT_EQ(diagnosis.checks_size(), 3);
    EXPECT_EQ(diagnosis.checks(0).finding(), "CP2102");
    EXPECT_EQ(diagnosis.checks(1).verdict(), v1::Diagnosis::FAILED);
    EXPECT_EQ(diagnosis.checks(2).verdict(), v1::Diagnosis::NOT_RUN);
    EXPECT_EQ(diagnosis.cause(), "it does not open");
    EXPECT_THAT(diagnosis.likely_causes(), ElementsAre("rust"));
    EXPECT_THAT(diagnosis.next_steps(), ElementsAre("oil", "wait"));
}

TEST_F(ApiTest, SaysWhyThereIsNoDiagnosis) {
    control.problem = device::advice(device::errc::shutting_down);
    const auto response = ask("GET", "/api/v1/lidars/A0E1C2D3/diagnosis");
    EXPECT_EQ(response.status, 503);
    EXPECT_EQ(error_in(response).code(), "shutting_down");
}

TEST_F(ApiTest, GivesTheLatestSweepAsJson) {
    publish_sweep();
    const auto response = ask("GET", "/api/v1/lidars/A0E1C2D3/scan");
    EXPECT_EQ(response.status, 200);
    v1::LatestScan scan;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(response.body, &scan).ok());
    EXPECT_EQ(scan.sequence(), 9U);
    EXPECT_EQ(scan.angle_deg_size(), 3);
}

TEST_F(ApiTest, GivesTheLatestSweepAsCsvByFormatOrAccept) {
    publish_sweep();
    const auto by_format = ask("GET", "/api/v1/lidars/A0E1C2D3/scan?format=csv");
    const auto by_accept = ask("GET", "/api/v1/lidars/A0E1C2D3/scan", "", "text/csv");
    EXPECT_EQ(by_format.content_type, "text/csv; charset=utf-8");
    EXPECT_THAT(by_format.body, HasSubstr("angle_deg,distance_mm,quality,time_us\n"));
    EXPECT_EQ(by_accept.body, by_format.body);
}

TEST_F(ApiTest, SaysThatTheLatestSweepOfAStoppedLidarIsOld) {
    publish_sweep(std::chrono::hours(1));
    publish_phase(device::Phase::idle);
    const auto response = ask("GET", "/api/v1/lidars/A0E1C2D3/scan");
    v1::LatestScan scan;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(response.body, &scan).ok());
    EXPECT_EQ(scan.state(), v1::Lidar::IDLE);
    EXPECT_GE(scan.age_ms(), 3'600'000U);
    const auto csv = ask("GET", "/api/v1/lidars/A0E1C2D3/scan?format=csv");
    EXPECT_EQ(header_of(csv, "Lidar-State"), "IDLE");
    EXPECT_GE(std::stoull(header_of(csv, "Sweep-Age-Ms")), 3'600'000U);
}

TEST_F(ApiTest, RefusesParametersThatItDoesNotKnow) {
    publish_sweep();
    const auto scan = ask("GET", "/api/v1/lidars/A0E1C2D3/scan?format=csv&bins=360");
    EXPECT_EQ(scan.status, 400);
    EXPECT_EQ(error_in(scan).code(), "unknown_parameter");
    EXPECT_EQ(error_in(scan).message(), "no parameter \"bins\"");
    EXPECT_EQ(error_in(scan).hint(), "parameters: format");
    const std::string lidar = "/api/v1/lidars/A0E1C2D3";
    const std::vector<std::pair<std::string, std::string>> others{
        {"GET", "/healthz"},
        {"GET", "/api/v1/lidars"},
        {"GET", "/api/v1/dictionaries/" + std::to_string(frame::dictionary_id())},
        {"GET", lidar},
        {"HEAD", lidar},
        {"GET", lidar + "/diagnosis"},
        {"PATCH", lidar},
        {"POST", lidar + "/start"},
        {"POST", lidar + "/stop"},
        {"POST", lidar + "/reset"}};
    for (const auto& [method, path] : others) {
        const auto refused = ask(method, path + "?mode=Express");
        EXPECT_EQ(refused.status, 400) << method << " " << path;
        EXPECT_EQ(error_in(refused).code(), "unknown_parameter") << path;
        EXPECT_EQ(error_in(refused).hint(), "this request takes no query parameters") << path;
    }
    EXPECT_TRUE(control.orders.empty()) << "nothing was done";
}

TEST_F(ApiTest, ErrorsShowTheBytesOfARequestThatAreNotUtf8) {
    publish_sweep();
    EXPECT_EQ(error_in(ask("GET", "/api/v1/lidars/%ff")).message(), "there is no lidar \"\\xff\"");
    EXPECT_EQ(error_in(ask("GET", "/api/v1/lidars?a%ff=1")).message(), "no parameter \"a\\xff\"");
    const auto format = ask("GET", "/api/v1/lidars/A0E1C2D3/scan?format=%ff");
    EXPECT_EQ(format.status, 400);
    EXPECT_THAT(error_in(format).message(), HasSubstr("\"\\xff\""));
    EXPECT_EQ(error_in(ask("GET", "/%ff")).message(), "there is nothing at /\\xff");
}

TEST_F(ApiTest, ErrorsShowControlCharactersOfARequestAsEscapes) {
    EXPECT_EQ(
        error_in(ask("GET", "/api/v1/lidars/a%1b%0ab")).message(),
        "there is no lidar \"a\\u001b\\nb\""
    );
}

TEST_F(ApiTest, RefusesAParameterThatIsThereTwice) {
    publish_sweep();
    const auto response = ask("GET", "/api/v1/lidars/A0E1C2D3/scan?format=csv&format=json");
    EXPECT_EQ(response.status, 400);
    EXPECT_EQ(error_in(response).code(), "repeated_parameter");
    EXPECT_EQ(error_in(response).message(), "the parameter \"format\" is given twice");
}

TEST_F(ApiTest, HealthCountsLidarsAndSubscribers) {
    const auto response = ask("GET", "/healthz");
    v1::HealthzResponse health;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(response.body, &health).ok());
    EXPECT_EQ(health.status(), "ok");
    EXPECT_EQ(health.lidars(), 1U);
    EXPECT_EQ(health.scanning(), 1U);
}

TEST_F(ApiTest, AnswersHeadLikeGet) {
    EXPECT_EQ(ask("HEAD", "/healthz").status, 200);
}

}  // namespace
}  // namespace sweepcast::api
