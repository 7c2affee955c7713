// `sweepcast capture`: what was on the line is in the file, and comes out of it again.
#include "driver/capture/capture_reader.hpp"
#include "driver/capture/stream_finder.hpp"
#include "tests/e2e/gateway.hpp"
#include "tests/e2e/relay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <ostream>
#include <sstream>
#include <sys/stat.h>

namespace sweepcast::test {
namespace {

using capture::CaptureReader;
using capture::Direction;
using testing::HasSubstr;
using testing::StartsWith;
using Bytes = std::vector<std::uint8_t>;

struct Outcome {
    int exit_code{};
    std::string output, log;
};

Outcome finish(Process& process) {
    const int exit_code = process.wait();
    return {exit_code, process.rest_of_output(), process.rest_of_log()};
}

Outcome run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), program());
    Process process(arguments);
    return finish(process);
}

Outcome shell(const std::string& script) {
    Process process({"/bin/sh", "-c", script});
    return finish(process);
}

std::string content(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream all;
    all << file.rdbuf();
    return all.str();
}

Bytes bytes_of(const std::string& path) {
    const auto text = content(path);
    return {text.begin(), text.end()};
}

/// A capture as it is in a file.
struct Captured {
    capture::CaptureHeader header;
    CaptureReader::End end{};
    protocol::AnswerType type{};        ///< of the first stream
    Bytes stream;                       ///< the first one
    Bytes measurements;                 ///< and what came of it after it was told to stop
    Bytes from_device, to_device;       ///< all
    std::chrono::nanoseconds length{};  ///< from the first record to the last
};

void append(Bytes& to, std::span<const std::uint8_t> bytes) {
    to.insert(to.end(), bytes.begin(), bytes.end());
}

Captured parse(std::istream& in) {
    auto reader = CaptureReader::open(in);
    if (!reader) {
        throw std::runtime_error(reader.error().cause);
    }
    Captured captured;
    captured.header = reader->header();
    capture::StreamFinder finder;
    bool begun = false;
    while (const auto record = reader->next()) {
        captured.length = record->at;
        const bool from_device = record->direction == Direction::from_device;
        append(from_device ? captured.from_device : captured.to_device, record->bytes);
        const auto block = finder.push(*record);
        if (block) {
            begun = true;
            captured.type = block->type;
            append(captured.stream, block->bytes);
            append(captured.measurements, block->bytes);
        } else if (begun && from_device) {
            append(captured.measurements, record->bytes);
        }
    }
    captured.end = reader->end();
    return captured;
}

Captured load(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return parse(file);
}

/// What `sweepcast decode` makes of the first stream's raw bytes.
Outcome decode_raw(const Captured& captured, const std::string& scratch) {
    std::ofstream(scratch, std::ios::binary)
        .write(
            std::string(captured.stream.begin(), captured.stream.end()).data(),
            static_cast<std::streamsize>(captured.stream.size())
        );
    const auto type = std::to_string(static_cast<int>(captured.type) - 0x81 + 81);
    const std::chrono::duration<double, std::micro> sample = captured.header.sample_duration;
    return run({"decode", "--type", type, "--sample-us", std::to_string(sample.count()), scratch});
}

/// Whether `captured` is what was sent, bit for bit. A few last bytes may be missing: what a lidar
/// still sends when it has been told to stop is waited for, but not for ever.
testing::AssertionResult is_all_but_the_end(const Bytes& captured, const Bytes& sent) {
    constexpr std::size_t few = 4096;
    const auto message = std::to_string(captured.size()) + " of " + std::to_string(sent.size());
    const bool begins = captured.size() <= sent.size() &&
                        std::equal(captured.begin(), captured.end(), sent.begin());
    return begins && sent.size() - captured.size() <= few
               ? testing::AssertionSuccess()
               : testing::AssertionFailure() << message << " bytes";
}

struct Scanner {
    std::string name;
    std::vector<std::string> options;  ///< of `sweepcast virtual`
    std::string mode;                  ///< empty: the typical
    protocol::AnswerType type{};
    std::string model;
    std::uint32_t baud{};
};

void PrintTo(const Scanner& scanner, std::ostream* out) {
    *out << scanner.name;
}

class CaptureScannerTest : public testing::TestWithParam<Scanner> {
protected:
    /// Plays a virtual lidar with these options and captures from it with those, until nothing is
    /// lost.
    Outcome capture_undisturbed(
        std::vector<std::string> options,
        const std::vector<std::string>& arguments,
        const std::string& file
    ) {
        options.insert(options.end(), {"--control", scratch.file("control")});
        for (int i = 0; i < most_runs; ++i) {
            std::filesystem::remove(file);
            lidar.reset();
            lidar = std::make_unique<VirtualLidarProcess>(options);
            std::vector<std::string> command{"capture", lidar->port, "-o", file};
            command.insert(command.end(), arguments.begin(), arguments.end());
            auto outcome = run(command);
            if (lost_nothing(scratch.file("control"))) {
                return outcome;
            }
        }
        throw std::runtime_error("the machine is too busy to read a lidar");
    }

    const ScratchDirectory scratch;
    std::unique_ptr<VirtualLidarProcess> lidar;  ///< of the last run
};

TEST_P(CaptureScannerTest, IsWhatWasOnTheLineAndComesOutOfItAgain) {
    const auto& scanner = GetParam();
    auto options = scanner.options;
    options.insert(options.end(), {"--record", scratch.file("sent")});
    const auto file = scratch.file("first");
    std::vector<std::string> arguments{"--seconds", "0.7"};
    if (!scanner.mode.empty()) {
        arguments.insert(arguments.end(), {"--mode", scanner.mode});
    }
    const auto outcome = capture_undisturbed(options, arguments, file);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.log;
    EXPECT_THAT(outcome.log, HasSubstr("0 checksum errors, 0 bytes skipped, 0 packets lost"));
    const auto first = load(file);
    EXPECT_EQ(first.end, CaptureReader::End::whole);
    EXPECT_EQ(first.type, scanner.type);
    EXPECT_EQ(first.header.answer_type, scanner.type);
    EXPECT_EQ(first.header.model, scanner.model);
    EXPECT_EQ(first.header.baud, scanner.baud);
    EXPECT_THAT(first.header.program, StartsWith("sweepcast "));
    EXPECT_GT(first.stream.size(), 2000U);
    EXPECT_GE(first.length, std::chrono::milliseconds(700));

    lidar->process.signal(SIGTERM);
    ASSERT_EQ(lidar->process.wait(), 0);
    EXPECT_TRUE(is_all_but_the_end(first.measurements, bytes_of(scratch.file("sent"))));

    const auto decoded = run({"decode", file});
    const auto decoded_raw = decode_raw(first, scratch.file("raw"));
    EXPECT_EQ(decoded.exit_code, 0) << decoded.log;
    EXPECT_EQ(decoded_raw.exit_code, 0) << decoded_raw.log;
    EXPECT_GT(std::ranges::count(decoded.output, '\n'), 500);
    EXPECT_TRUE(decoded.output == decoded_raw.output);

    std::vector<std::string> play{"--play", file};
    if (scanner.baud == 0) {
        play.insert(play.end(), {"--listen", lidar->port.substr(0, 6) + "127.0.0.1:0"});
    }
    const auto played =
        capture_undisturbed(play, {"--mode", first.header.mode}, scratch.file("second"));
    EXPECT_EQ(played.exit_code, 1);
    EXPECT_THAT(played.log, HasSubstr("is kept in " + scratch.file("second"))) << "it falls silent";
    const auto second = load(scratch.file("second"));
    EXPECT_EQ(second.end, CaptureReader::End::whole);
    EXPECT_EQ(second.type, first.type);
    EXPECT_EQ(second.header.serial, first.header.serial);
    EXPECT_EQ(second.header.mode, first.header.mode);
    EXPECT_TRUE(second.stream == first.stream)
        << second.stream.size() << " of " << first.stream.size() << " bytes";
}

using protocol::AnswerType;

INSTANTIATE_TEST_SUITE_P(
    Scanners,
    CaptureScannerTest,
    testing::Values(
        Scanner{"a1m8", {"--model", "a1m8"}, "", AnswerType::express, "A1M8", 115'200},
        Scanner{
            "a1m8standard",
            {"--model", "a1m8"},
            "standard",
            AnswerType::normal,
            "A1M8",
            115'200},
        Scanner{
            "a2m8old",
            {"--model", "a2m8-old"},
            "Standard",
            AnswerType::normal,
            "A2M8",
            115'200},
        Scanner{"a3m1", {"--model", "a3m1"}, "", AnswerType::ultra, "A3M1", 256'000},
        Scanner{"s2", {"--model", "s2"}, "1", AnswerType::dense, "S2M1-R2L", 1'000'000},
        Scanner{"s3", {"--model", "s3"}, "HQ", AnswerType::hq, "S3M1", 1'000'000},
        Scanner{"c1", {"--model", "c1"}, "", AnswerType::ultra_dense, "C1M1-R2", 460'800},
        Scanner{
            "s1tcp",
            {"--model", "s1", "--listen", "tcp://127.0.0.1:0"},
            "",
            AnswerType::dense,
            "S1M1",
            0},
        Scanner{
            "t1udp",
            {"--model", "t1", "--listen", "udp://127.0.0.1:0"},
            "",
            AnswerType::dense,
            "T1M1",
            0}
    ),
    [](const auto& tested) { return tested.param.name; }
);

class CaptureRelayTest : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(CaptureRelayTest, EveryByteInBothDirectionsIsThere) {
    const ScratchDirectory scratch;
    const VirtualLidarProcess lidar(GetParam());
    Relay relay(lidar.port);
    const auto outcome =
        run({"capture", relay.url(), "--seconds", "0.5", "-o", scratch.file("capture")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.log;
    const auto passed = relay.finish();
    const auto captured = load(scratch.file("capture"));
    EXPECT_TRUE(captured.to_device == passed.to_device)
        << captured.to_device.size() << " of " << passed.to_device.size();
    EXPECT_TRUE(is_all_but_the_end(captured.from_device, passed.from_device));
}

INSTANTIATE_TEST_SUITE_P(
    Networks,
    CaptureRelayTest,
    testing::Values(
        std::vector<std::string>{"--model", "s1", "--listen", "tcp://127.0.0.1:0"},
        std::vector<std::string>{"--model", "t1", "--listen", "udp://127.0.0.1:0"}
    ),
    [](const auto& tested) { return tested.param.back().substr(0, 3); }
);

/// A pipe in the file system, held open for reading, so that the test knows how far a capture is.
class Fifo {
public:
    explicit Fifo(std::string path) : path_(std::move(path)) {
        if (::mkfifo(path_.c_str(), 0600) != 0) {
            throw std::runtime_error("no pipe");
        }
    }
    [[nodiscard]] const std::string& path() const { return path_; }
    void open() { in_.open(path_, std::ios::binary); }
    void read(std::size_t count) {
        std::string more(count, '\0');
        in_.read(more.data(), static_cast<std::streamsize>(count));
        all_ << more;
    }
    Captured rest() {
        for (char c = 0; in_.get(c);) {
            all_ << c;
        }
        return parse(all_);
    }

private:
    std::string path_;
    std::ifstream in_;
    std::stringstream all_;
};

class CaptureStopTest : public testing::TestWithParam<int> {};

TEST_P(CaptureStopTest, LeavesAWholeFileAndAStillLidar) {
    const ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--model", "a1m8"});
    Fifo fifo(scratch.file("fifo"));
    Process capture({program(), "capture", lidar.port, "-o", fifo.path()});
    fifo.open();
    fifo.read(20'000);
    capture.signal(GetParam());
    const auto captured = fifo.rest();
    const auto outcome = finish(capture);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.log, HasSubstr("sweeps, 0 checksum errors"));
    EXPECT_EQ(captured.end, CaptureReader::End::whole);
    EXPECT_GT(captured.stream.size(), 10'000U);
    lidar.process.wait_for_log("scan stopped");
    lidar.process.wait_for_log("motor off");
    EXPECT_TRUE(captured.measurements.size() >= captured.stream.size());
}

INSTANTIATE_TEST_SUITE_P(
    Signals,
    CaptureStopTest,
    testing::Values(SIGINT, SIGTERM),
    [](const auto& tested) { return tested.param == SIGINT ? "interrupt" : "terminate"; }
);

TEST(CaptureTest, ASignalBeforeTheScanLeavesNoFile) {
    const ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--model", "a1m8", "--fault", "mute"});
    Process capture(
        {program(), "capture", lidar.port, "--baud", "115200", "-o", scratch.file("capture")}
    );
    lidar.process.wait_for_log("opened by a host");
    capture.signal(SIGINT);
    const auto outcome = finish(capture);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.log, HasSubstr("stopped before anything was captured"));
    EXPECT_FALSE(std::filesystem::exists(scratch.file("capture")));
}

TEST(CaptureTest, AFileThatExistsIsKeptUnlessForced) {
    const ScratchDirectory scratch;
    const auto file = scratch.file("precious");
    std::ofstream(file) << "precious";
    const VirtualLidarProcess lidar({"--model", "a1m8"});
    const auto refused = run({"capture", lidar.port, "--seconds", "0.1", "-o", file});
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_THAT(refused.log, HasSubstr(file + " exists already"));
    EXPECT_THAT(refused.log, HasSubstr("--force"));
    EXPECT_EQ(content(file), "precious");
    const auto forced = run({"capture", lidar.port, "--seconds", "0.1", "-o", file, "--force"});
    EXPECT_EQ(forced.exit_code, 0) << forced.log;
    EXPECT_EQ(load(file).end, CaptureReader::End::whole);
}

TEST(CaptureTest, AFullDiskIsToldAndTheLidarLeftStill) {
    VirtualLidarProcess lidar({"--model", "a1m8"});
    const auto outcome = run({"capture", lidar.port, "-o", "/dev/full"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.log, HasSubstr("cannot write /dev/full: No space left on device"));
}

TEST(CaptureTest, ADiskThatFillsUpKeepsWhatItHolds) {
    const ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--model", "s2"});
    const auto file = scratch.file("capture");
    // A limit of the shell's stands in for the end of the disk: so many blocks of 512 bytes.
    const auto outcome = shell(
        "trap '' XFSZ; ulimit -f 60; exec " + program() + " capture " + lidar.port + " -o " + file
    );
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.log, HasSubstr("cannot write " + file + ": File too large"));
    EXPECT_THAT(outcome.log, HasSubstr("can still be decoded"));
    EXPECT_GT(load(file).stream.size(), 10'000U);
    lidar.process.wait_for_log("motor off");
    EXPECT_EQ(run({"decode", file}).exit_code, 0);
}

TEST(CaptureTest, AReaderThatGoesEndsIt) {
    VirtualLidarProcess lidar({"--model", "a1m8"});
    const auto outcome =
        shell(program() + " capture " + lidar.port + " -o - | head -c 10000 > /dev/null");
    EXPECT_THAT(outcome.log, HasSubstr("nobody reads it any more"));
    lidar.process.wait_for_log("motor off");
}

TEST(CaptureTest, StandardOutputCanBeDecodedAtOnce) {
    const VirtualLidarProcess lidar({"--model", "s2"});
    const auto outcome = shell(
        program() + " capture " + lidar.port + " --seconds 0.3 -o - | " + program() + " decode"
    );
    EXPECT_EQ(outcome.exit_code, 0) << outcome.log;
    EXPECT_THAT(outcome.output, StartsWith("angle_z_q14,dist_mm_q2,quality,flag\n"));
    EXPECT_GT(std::ranges::count(outcome.output, '\n'), 3000);
    EXPECT_THAT(outcome.log, HasSubstr("S2M1-R2L"));
}

TEST(CaptureTest, ALidarThatVanishesIsToldAndWhatItSaidIsKept) {
    const ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--model", "a1m8"});
    Fifo fifo(scratch.file("fifo"));
    Process capture({program(), "capture", lidar.port, "-o", fifo.path()});
    fifo.open();
    fifo.read(20'000);
    lidar.process.signal(SIGKILL);
    const auto captured = fifo.rest();
    const auto outcome = finish(capture);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.log, HasSubstr("what it said until then is kept in " + fifo.path()));
    EXPECT_EQ(captured.end, CaptureReader::End::whole);
    EXPECT_GT(captured.stream.size(), 10'000U);
}

TEST(CaptureTest, APortInUseIsLeftAlone) {
    const ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--model", "a1m8"});
    Process first({program(), "capture", lidar.port, "-o", scratch.file("first")});
    lidar.process.wait_for_log("scan started");
    const auto second = run({"capture", lidar.port, "-o", scratch.file("second")});
    EXPECT_EQ(second.exit_code, 1);
    EXPECT_THAT(second.log, HasSubstr("in use by sweepcast"));
    EXPECT_FALSE(std::filesystem::exists(scratch.file("second")));
    first.signal(SIGINT);
    EXPECT_EQ(first.wait(), 0);
}

TEST(CaptureTest, TheOneLidarThatIsFoundIsCapturedUnderANameOfItsOwn) {
    const ScratchDirectory scratch;
    const VirtualLidarProcess lidar(
        {"--model", "c1", "--link", scratch.file("lidar-1"), "--serial", std::string(32, 'B')}
    );
    const auto outcome = shell(
        "cd " + scratch.file("") + " && SWEEPCAST_DISCOVER='" + scratch.file("lidar-*") + "' " +
        program() + " capture --seconds 0.3 && ls"
    );
    EXPECT_EQ(outcome.exit_code, 0) << outcome.log;
    const auto name = outcome.output.substr(0, outcome.output.find('\n'));
    EXPECT_THAT(name, testing::MatchesRegex("C1M1-R2-BBBBBBBB-[0-9]*T[0-9]*Z\\.sweepcast"));
    EXPECT_EQ(load(scratch.file(name)).header.baud, 460'800U);
}

TEST(CaptureTest, NoneOrSeveralLidarsAreNotChosenFrom) {
    const ScratchDirectory scratch;
    const auto call = "SWEEPCAST_DISCOVER='" + scratch.file("lidar-*") + "' " + program() +
                      " capture -o " + scratch.file("capture");
    const auto none = shell(call);
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_THAT(none.log, HasSubstr("no lidar was found"));
    EXPECT_THAT(none.log, HasSubstr("sweepcast capture /dev/ttyUSB0"));
    const VirtualLidarProcess first({"--link", scratch.file("lidar-1")});
    const VirtualLidarProcess second({"--link", scratch.file("lidar-2")});
    const auto several = shell(call);
    EXPECT_EQ(several.exit_code, 1);
    EXPECT_THAT(several.log, HasSubstr("there are 2 lidars"));
    EXPECT_THAT(several.log, HasSubstr("sweepcast capture " + scratch.file("lidar-1")));
    EXPECT_FALSE(std::filesystem::exists(scratch.file("capture")));
}

TEST(CaptureTest, WishesThatTheLidarCannotFulfilAreNamed) {
    const ScratchDirectory scratch;
    const auto file = scratch.file("capture");
    const VirtualLidarProcess c1({"--model", "c1"});
    const auto mode = run({"capture", c1.port, "-o", file, "--mode", "Boots"});
    EXPECT_EQ(mode.exit_code, 1);
    EXPECT_THAT(mode.log, HasSubstr("this lidar has: Standard, UltraDense"));
    const auto speed = run({"capture", c1.port, "-o", file, "--speed", "7"});
    EXPECT_EQ(speed.exit_code, 1);
    EXPECT_THAT(speed.log, HasSubstr("0 withdraws the wish"));
    const VirtualLidarProcess broken({"--model", "a1m8", "--fault", "protection-stop"});
    const auto stopped = run({"capture", broken.port, "-o", file});
    EXPECT_EQ(stopped.exit_code, 1);
    EXPECT_THAT(stopped.log, HasSubstr("reset it"));
    EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(CaptureTest, TheMotorTurnsAsFastAsAsked) {
    const ScratchDirectory scratch;
    const VirtualLidarProcess lidar({"--model", "s2"});
    const auto file = scratch.file("capture");
    const auto outcome =
        run({"capture", lidar.port, "--speed", "7", "--seconds", "0.2", "-o", file});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.log;
    const Bytes rpm_420{0xA5, 0xA8, 0x02, 0xA4, 0x01};
    const auto sent = load(file).to_device;
    EXPECT_NE(std::search(sent.begin(), sent.end(), rpm_420.begin(), rpm_420.end()), sent.end());
}

TEST(CaptureTest, DecodeTellsHowACaptureEnds) {
    const ScratchDirectory scratch;
    const VirtualLidarProcess lidar({"--model", "a1m8"});
    const auto file = scratch.file("capture");
    ASSERT_EQ(run({"capture", lidar.port, "--seconds", "0.3", "-o", file}).exit_code, 0);
    const auto whole = content(file);
    std::ofstream(scratch.file("short"), std::ios::binary) << whole.substr(0, whole.size() / 2);
    std::ofstream(scratch.file("damaged"), std::ios::binary) << whole << "no record at all";
    std::ofstream(scratch.file("beheaded"), std::ios::binary) << whole.substr(0, 60);

    const auto cut = run({"decode", scratch.file("short")});
    EXPECT_EQ(cut.exit_code, 0) << cut.log;
    EXPECT_THAT(run({"decode", file}).output, StartsWith(cut.output));
    const auto damaged = run({"decode", scratch.file("damaged")});
    EXPECT_EQ(damaged.exit_code, 1);
    EXPECT_THAT(damaged.log, HasSubstr("the capture is damaged"));
    EXPECT_EQ(damaged.output, run({"decode", file}).output);
    const auto beheaded = run({"decode", scratch.file("beheaded")});
    EXPECT_EQ(beheaded.exit_code, 1);
    EXPECT_THAT(beheaded.log, HasSubstr("header of the capture is cut short"));
    const auto typed = run({"decode", "--type", "82", file});
    EXPECT_EQ(typed.exit_code, 2);
    EXPECT_THAT(typed.log, HasSubstr("leave --type out"));
    const auto piped = shell("cat " + file + " | " + program() + " decode --units");
    EXPECT_EQ(piped.exit_code, 0);
    EXPECT_EQ(
        std::ranges::count(piped.output, '\n'),
        std::ranges::count(run({"decode", file}).output, '\n')
    );
}

}  // namespace
}  // namespace sweepcast::test
