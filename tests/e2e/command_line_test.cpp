// What the program says when it is called rightly and wrongly.
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Outcome {
    int exit_code;
    std::string output, log;
};

Outcome call(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), program());
    Process process(arguments);
    const int exit_code = process.wait();
    return {exit_code, process.rest_of_output(), process.rest_of_log()};
}

TEST(CommandLine, HelpHasExamplesForEveryCommand) {
    for (const auto* command :
         {"serve", "watch", "virtual", "probe", "doctor", "address", "capture", "decode"}) {
        const auto help = call({command, "--help"});
        EXPECT_EQ(help.exit_code, 0) << command;
        EXPECT_THAT(help.output, HasSubstr("Example")) << command;
    }
}

struct Mistake {
    std::vector<std::string> arguments;
    std::string says;
};

class MistakeTest : public testing::TestWithParam<Mistake> {};

TEST_P(MistakeTest, IsNamedAndEndsTheProgram) {
    const auto outcome = call(GetParam().arguments);
    EXPECT_NE(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output + outcome.log, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    Calls,
    MistakeTest,
    testing::Values(
        Mistake{{"serve", "--http", "nowhere"}, "127.0.0.1:8080"},
        Mistake{
            {"serve", "--lidar", "virtual:a1m8", "--host-name", "http://robot"},
            "robot.example.com"},
        Mistake{{"serve", "--lidar", "usb://1"}, "virtual:a1m8"},
        Mistake{{"serve", "--lidar", "virtual:z9"}, "z9"},
        Mistake{{"serve", "--lidar", "virtual:a1m8?world=/nonexistent.csv"}, "/nonexistent.csv"},
        Mistake{{"serve", "--log-level", "loud"}, "debug"},
        Mistake{{"serve", "--threads", "0"}, "--threads"},
        Mistake{{"watch", "http://robot"}, "tcp://127.0.0.1:8081"},
        Mistake{{"watch", "tcp://127.0.0.1:1?lidar=X"}, "--lidar"},
        Mistake{{"watch", "ws://127.0.0.1:1?kind=sweep", "--kind", "sector"}, "one place"},
        Mistake{{"watch", "--keep", "90"}, "FROM-TO"},
        Mistake{{"watch", "tcp://[::1]:1"}, "curl http://[::1]:8080/healthz"},
        Mistake{{"watch", "tcp://127.0.0.1:1"}, "cannot connect to 127.0.0.1:1"},
        Mistake{{"virtual", "--model", "z9"}, "a2m12"},
        Mistake{{"virtual", "--fault", "noise"}, "noise=RATE"},
        Mistake{{"virtual", "--listen", "nowhere"}, "tcp://127.0.0.1:20108"},
        Mistake{{"virtual", "--play", "/nonexistent"}, "/nonexistent"},
        Mistake{{"virtual", "--loop"}, "--play"},
        Mistake{{"virtual", "--schedule", "3 unplug"}, "3s unplug, 5s replug"},
        Mistake{{"virtual", "--schedule", "3s explode"}, "replug [LINK_PATH]"},
        Mistake{{"virtual", "--control", "/nonexistent/control"}, "/nonexistent/control"},
        Mistake{{"virtual", "--control", "/nonexistent", "--send", "unplug"}, "--control /nonexis"},
        Mistake{{"virtual", "--send", "unplug"}, "--control PATH"},
        Mistake{{"virtual", "--truth", "/nonexistent/truth"}, "/nonexistent/truth"},
        Mistake{{"serve", "--lidar", "virtual:a1m8?fault=nonsense"}, "protection-stop"},
        Mistake{{"serve", "--lidar", "virtual:a1m8?schedule=unplug"}, "3s unplug, 5s replug"},
        Mistake{{"probe", "/nonexistent"}, "/nonexistent"},
        Mistake{{"probe", "/etc/passwd"}, "/etc/passwd"},
        Mistake{{"doctor", "usb://1"}, "udp://"},
        Mistake{{"doctor", "/etc/passwd"}, "/etc/passwd is a regular file"},
        Mistake{{"doctor", "--discover", "x", "y"}, "--discover"},
        Mistake{{"address", "/nonexistent"}, "/nonexistent"},
        Mistake{{"address", "udp://127.0.0.1:1", "--ip", "10.0.0.256"}, "--ip 192.168.11.2"},
        Mistake{{"capture", "/nonexistent"}, "/nonexistent"},
        Mistake{{"capture", "/nonexistent", "-o", "/etc"}, "cannot write /etc: Is a directory"},
        Mistake{{"capture", "/nonexistent", "-o", "/nonexistent/file"}, "No such file"},
        Mistake{{"capture", "/nonexistent", "-o", "/etc/passwd"}, "/etc/passwd exists already"},
        Mistake{{"capture", "/nonexistent", "--seconds", "0"}, "--seconds"},
        Mistake{{"capture", "udp://127.0.0.1:1", "--baud", "115200"}, "serial ports"},
        Mistake{{"decode", "/etc/passwd"}, "--type"},
        Mistake{{"decode", "--type", "x", "/etc/passwd"}, "0x84 (ultra)"},
        Mistake{{"decode", "--type", "84", "/nonexistent"}, "/nonexistent"},
        Mistake{{"decode", "--type", "84", "/etc"}, "/etc"},
        Mistake{{"decode", "--type", "84", "--sample-us", "-1", "/etc/passwd"}, "--sample-us"}
    )
);

/// Command lines that cannot be obeyed whatever is plugged in, and what the error says.
class MisuseTest : public testing::TestWithParam<Mistake> {};

TEST_P(MisuseTest, ExitsWithTwoAndSaysWhatIsWrongOnStandardError) {
    const auto outcome = call(GetParam().arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.log, HasSubstr(GetParam().says));
    EXPECT_EQ(outcome.output, "");
}

TEST(CommandLine, AGatewayOfAnotherGatewaysLidarEndsIfThePortsAreTaken) {
    const GatewayProcess first({"--lidar", "virtual:a1m8"});
    const auto outcome = call(
        {"serve", "--lidar", "sweepcast://" + first.tcp, "--http", first.http, "--tcp", first.tcp}
    );
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.log, HasSubstr("cannot listen on " + first.http));
}

TEST(CommandLine, AWrongLidarIsNamedEvenIfThePortsAreTaken) {
    const GatewayProcess first({"--lidar", "virtual:a1m8"});
    const auto outcome =
        call({"serve", "--lidar", "virtual:z9", "--http", first.http, "--tcp", first.tcp});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.log, HasSubstr("z9"));
}

INSTANTIATE_TEST_SUITE_P(
    Calls,
    MisuseTest,
    testing::Values(
        Mistake{{}, "serve, watch, virtual, probe, doctor, address, capture, decode"},
        Mistake{{"dance"}, "there is no command \"dance\""},
        Mistake{{"dance", "--loudly"}, "there is no command \"dance\""},
        Mistake{{"\x1b[2J"}, "there is no command \"\\u001b[2J\""},
        Mistake{{"--loudly"}, "there is no option \"--loudly\""},
        Mistake{{"--loudly"}, "give a command first"},
        Mistake{{"serve", "--loudly"}, "--loudly"},
        Mistake{{"serve", "--threads", "0"}, "--threads"},
        Mistake{{"serve", "--threads", "many"}, "--threads"},
        Mistake{{"serve", "--http", "nowhere"}, "nowhere"},
        Mistake{{"serve", "--tcp", "nowhere"}, "nowhere"},
        Mistake{{"serve", "--log-level", "loud"}, "loud"},
        Mistake{{"serve", "--lidar", "usb://1"}, "usb://1"},
        Mistake{{"serve", "--lidar", "virtual:z9"}, "z9"},
        Mistake{{"serve", "--lidar", "virtual:a1m8?fault=nonsense"}, "nonsense"},
        Mistake{{"serve", "--lidar", "/dev/x?name=A", "--lidar", "/dev/y?name=A"}, "A"},
        Mistake{{"watch", "--loudly"}, "--loudly"},
        Mistake{{"watch", "http://robot"}, "http://robot"},
        Mistake{{"watch", "--csv", "--json"}, "--csv"},
        Mistake{{"watch", "--keep", "90"}, "FROM-TO"},
        Mistake{{"watch", "tcp://127.0.0.1:1?lidar=X"}, "--lidar"},
        Mistake{{"watch", "ws://127.0.0.1:1?kind=sweep", "--kind", "sector"}, "one place"},
        Mistake{{"virtual", "--loudly"}, "--loudly"},
        Mistake{{"virtual", "--model", "z9"}, "z9"},
        Mistake{{"virtual", "--fault", "noise"}, "noise=RATE"},
        Mistake{{"virtual", "--schedule", "3 unplug"}, "3 unplug"},
        Mistake{{"virtual", "--send", "unplug"}, "--control PATH"},
        Mistake{{"probe"}, "port"},
        Mistake{{"probe", "usb://1"}, "usb://1"},
        Mistake{{"doctor", "--discover", "x", "y"}, "--discover"},
        Mistake{{"doctor", "usb://1"}, "usb://1"},
        Mistake{{"address"}, "port"},
        Mistake{{"address", "usb://1"}, "usb://1"},
        Mistake{{"address", "udp://127.0.0.1:1", "--ip", "10.0.0.256"}, "10.0.0.256"},
        Mistake{{"capture", "usb://1"}, "usb://1"},
        Mistake{{"capture", "/nonexistent", "--seconds", "0"}, "--seconds"},
        Mistake{{"capture", "udp://127.0.0.1:1", "--baud", "115200"}, "serial ports"},
        Mistake{{"decode", "--loudly"}, "--loudly"},
        Mistake{{"decode", "--type", "x", "/etc/passwd"}, "0x84 (ultra)"},
        Mistake{{"decode", "/etc/passwd"}, "--type"}
    )
);

TEST(CommandLine, HelpTellsTheExitCodes) {
    EXPECT_THAT(call({"--help"}).output, HasSubstr("2    the command line is wrong"));
}

TEST(CommandLine, VirtualListsItsModels) {
    for (const auto& arguments :
         {std::vector<std::string>{"virtual", "--list-models"}, {"virtual", "--model", "list"}}) {
        const auto outcome = call(arguments);
        EXPECT_EQ(outcome.exit_code, 0);
        for (const auto* part : {"a1m8", "a2m8-old", "1000000", "UltraDense", "0x86", "UDP"}) {
            EXPECT_THAT(outcome.output, HasSubstr(part));
        }
    }
}

TEST(CommandLine, VirtualPrintsTheUrlItListensOn) {
    Process lidar({program(), "virtual", "--model", "t1", "--listen", "127.0.0.1:0"});
    EXPECT_THAT(lidar.wait_for_output("://"), StartsWith("udp://127.0.0.1:"));
    lidar.signal(SIGINT);
    EXPECT_EQ(lidar.wait(), 0);
}

TEST(CommandLine, ServeSaysThatItsAddressIsTaken) {
    GatewayProcess first({"--lidar", "virtual:a1m8"});
    const auto second =
        call({"serve", "--lidar", "virtual:a1m8", "--http", first.http, "--tcp", "127.0.0.1:0"});
    EXPECT_EQ(second.exit_code, 1);
    EXPECT_THAT(second.log, HasSubstr(first.http));
}

TEST(CommandLine, ServeOpenToTheNetworkWarnsAndPrintsAPageThatOpens) {
    Process serve(
        {program(),
         "serve",
         "--lidar",
         "virtual:a1m8",
         "--http",
         "0.0.0.0:0",
         "--tcp",
         "127.0.0.1:0"}
    );
    EXPECT_THAT(serve.wait_for_log("anyone who reaches it"), HasSubstr("--http 127.0.0.1:"));
    EXPECT_THAT(serve.wait_for_output("page: "), StartsWith("page: http://127.0.0.1:"));
}

TEST(CommandLine, ServeTakesNoMoreConnectionsThanDescriptorsAllow) {
    Process serve(
        {"/bin/sh",
         "-c",
         "ulimit -n 100; exec '" + program() +
             "' serve --lidar virtual:a1m8 --http 127.0.0.1:0 --tcp 127.0.0.1:0"}
    );
    const auto page = serve.wait_for_output("page: ");
    const auto address = page.substr(page.find("://") + 3, page.rfind('/') - page.find("://") - 3);
    std::vector<std::unique_ptr<HttpConnection>> clients;
    for (int i = 0; i < 18; ++i) {
        clients.push_back(std::make_unique<HttpConnection>(address));
        EXPECT_EQ(clients.back()->ask("GET", "/healthz").status, 200);
    }
    const HttpConnection one_more(address);
    EXPECT_THAT(serve.wait_for_log("connections refused"), HasSubstr("there are 18 already"));
}

TEST(CommandLine, ServeWithoutALidarStartsAVirtualOneAndSaysSo) {
    GatewayProcess gateway({});
    gateway.process.wait_for_log("starting a virtual one");
    Subscriber client("tcp://" + gateway.tcp);
    EXPECT_TRUE(client.wait_for_state(v1::Lidar::SCANNING).is_virtual());
}

TEST(CommandLine, ProbeTellsWhatIsThere) {
    VirtualLidarProcess lidar({"--serial", "00112233445566778899AABBCCDDEEFF"});
    const auto probed = call({"probe", lidar.port});
    EXPECT_EQ(probed.exit_code, 0);
    EXPECT_THAT(probed.output, HasSubstr("A1M8"));
    EXPECT_THAT(probed.output, HasSubstr("00112233445566778899AABBCCDDEEFF"));
    EXPECT_THAT(probed.output, HasSubstr("Express: 4000 samples/s"));
}

TEST(CommandLine, ProbeNamesWhoHoldsThePort) {
    VirtualLidarProcess lidar;
    GatewayProcess gateway({"--lidar", lidar.port});
    gateway.process.wait_for_log("scanning");
    const auto probed = call({"probe", lidar.port});
    EXPECT_EQ(probed.exit_code, 1);
    EXPECT_THAT(probed.log, HasSubstr("sweepcast"));
    EXPECT_THAT(probed.log, HasSubstr(std::to_string(gateway.process.pid())));
}

TEST(CommandLine, WatchPrintsTheSameSamplesOverTcpAndWebSocket) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Process over_tcp({program(), "watch", "tcp://" + gateway.tcp, "--csv", "--sweeps", "30"});
    gateway.process.wait_for_log("connected");
    Process over_websocket(
        {program(),
         "watch",
         "ws://" + gateway.http + "/api/v1/stream?compression=none",
         "--csv",
         "--sweeps",
         "3"}
    );
    EXPECT_EQ(over_tcp.wait(), 0);
    EXPECT_EQ(over_websocket.wait(), 0);
    const auto tcp = over_tcp.rest_of_output();
    const auto websocket = over_websocket.rest_of_output();
    EXPECT_THAT(tcp, StartsWith("lidar,sequence,unix_ns,angle_deg,distance_mm,quality,flag\n"));

    // The second began later; a sweep that both have must be the same line for line.
    const auto sweeps = websocket.substr(websocket.find('\n') + 1);
    const auto begin = tcp.find(sweeps.substr(0, sweeps.find('\n') + 1));
    ASSERT_NE(begin, std::string::npos) << "the two have no sweep in common";
    const auto common = std::min(sweeps.size(), tcp.size() - begin);
    EXPECT_EQ(tcp.substr(begin, common), sweeps.substr(0, common));
}

TEST(CommandLine, WatchPrintsTheWholeGreetingAndTheFinalStateToAPipe) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8", "--lidar", "virtual:a1m8"});
    for (int i = 0; i < 2; ++i) {
        gateway.process.wait_for_log("scanning");
    }
    const auto watched = call({"watch", "tcp://" + gateway.tcp, "--sweeps", "1"});
    EXPECT_EQ(watched.exit_code, 0);
    const auto last = watched.output.rfind("lidar  ");
    ASSERT_NE(last, std::string::npos);
    ASSERT_GT(last, 0U) << "only one table";
    const auto first_table = watched.output.substr(0, last);
    const auto last_table = watched.output.substr(last);
    constexpr auto heading_and_both_lidars = 3;
    EXPECT_EQ(std::ranges::count(last_table, '\n'), heading_and_both_lidars);
    EXPECT_EQ(std::ranges::count(first_table, '\n') % heading_and_both_lidars, 0) << first_table;
    EXPECT_NE(first_table.substr(first_table.find('\n')), last_table.substr(last_table.find('\n')))
        << "the sweep is not in the final state";
}

/// `watch` in a shell command, where WATCH stands for it.
Outcome call_watch(std::string shell_command, const std::string& url) {
    const std::string name = "WATCH";
    shell_command
        .replace(shell_command.find(name), name.size(), "'" + program() + "' watch '" + url + "'");
    Process shell({"/bin/sh", "-c", shell_command});
    const int exit_code = shell.wait();
    return {exit_code, shell.rest_of_output(), shell.rest_of_log()};
}

TEST(CommandLine, WatchSaysThatTheDiskIsFull) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    for (const auto* form : {"--csv", "--json", ""}) {
        const auto watched =
            call_watch(std::string("WATCH ") + form + " > /dev/full", "tcp://" + gateway.tcp);
        EXPECT_EQ(watched.exit_code, 1) << form;
        EXPECT_EQ(
            watched.log,
            "sweepcast: cannot write to standard output: No space left on device\n"
        ) << form;
    }
}

TEST(CommandLine, WatchEndsQuietlyWhenItsReaderHasEnough) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    const auto watched =
        call_watch("(WATCH --csv; echo \"ended with $?\" >&2) | head -n 1", "tcp://" + gateway.tcp);
    EXPECT_THAT(watched.output, StartsWith("lidar,sequence"));
    EXPECT_EQ(watched.log, "ended with 1\n");
}

TEST(CommandLine, WatchTakesAQueryWithoutAPath) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    const auto watched =
        call({"watch", "ws://" + gateway.http + "?compression=none", "--csv", "--sweeps", "1"});
    EXPECT_EQ(watched.exit_code, 0) << watched.log;
}

TEST(CommandLine, WatchGoesOnWhenTheGatewayComesBack) {
    const std::vector<std::string> lidar{"--lidar", "virtual:a1m8"};
    auto gateway = std::make_unique<GatewayProcess>(lidar);
    const auto stream = gateway->tcp;
    gateway->process.wait_for_log("scanning");
    const auto lidars = http(gateway->http, "GET", "/api/v1/lidars").body;
    const auto id = lidars.substr(lidars.find('"', lidars.find("\"id\":") + 5) + 1, 8);
    Process watch({program(), "watch", "tcp://" + stream, "--csv", "--lidar", id});
    watch.wait_for_output(id + ",");
    gateway->process.signal(SIGTERM);
    gateway->process.wait();
    watch.wait_for_log("shutting down; trying again");
    gateway = std::make_unique<GatewayProcess>(
        std::vector<std::string>{"--lidar", "virtual:a1m8", "--tcp", stream}
    );
    watch.wait_for_log("connected again");
    watch.wait_for_output(id + ",1,");
    watch.signal(SIGINT);
    EXPECT_EQ(watch.wait(), 0);

    Process once({program(), "watch", "tcp://" + stream, "--csv", "--no-reconnect"});
    once.wait_for_output(id + ",");
    gateway.reset();
    EXPECT_EQ(once.wait(), 1);
}

TEST(CommandLine, WatchEndsWhenTold) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Process watch({program(), "watch", "tcp://" + gateway.tcp, "--json"});
    watch.wait_for_output("\"angle_deg\"");
    watch.signal(SIGINT);
    EXPECT_EQ(watch.wait(), 0);
}

}  // namespace
}  // namespace sweepcast::test
