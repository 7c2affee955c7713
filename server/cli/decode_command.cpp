#include "server/cli/decode_command.hpp"

#include "driver/protocol/decode.hpp"
#include "driver/protocol/sweep.hpp"
#include "server/cli/answer_type_names.hpp"
#include "server/cli/byte_source.hpp"
#include "server/cli/command.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <iterator>
#include <memory>
#include <string>

namespace sweepcast::cli {

namespace {

using protocol::AnswerType;
using protocol::Decoded;
using protocol::DecodeEventKind;
using protocol::Sample;

constexpr const char* footer = R"(
Prints a header line and then a line a sample, in the units of the line: angles in 1/65536 turn, distances in
quarter millimetres (0: no echo). Bit 0 of the flag is set where a revolution begins. What was damaged is told on
standard error. A capsule (0x82, 0x84, 0x85, 0x86) is complete with the beginning of the next one, so the samples
of the last one do not come out.

Examples:
  sweepcast decode --type 0x84 --sample-us 63 scan.bin > scan.csv
  sweepcast decode --type dense --sample-us 31 --units scan.bin
  cat /tmp/recorded | sweepcast decode --type 82 | head)";

struct DecodeArguments {
    std::string path{"-"};
    std::string type;
    std::uint32_t sample_us{};
    bool units{};
};

/// Prints samples and counts what comes out.
class Printer {
public:
    explicit Printer(bool units) : units_(units) {
        text_ = units ? "angle_deg,distance_mm,quality,flag\n"
                      : "angle_z_q14,dist_mm_q2,quality,flag\n";
    }

    /// Why standard output took no more, if it did not.
    error_code print(const Decoded& decoded) {
        for (const auto& sample : decoded.samples) {
            add(sample);
        }
        samples_ += decoded.samples.size();
        for (const auto& event : decoded.events) {
            count(event);
        }
        const bool written = std::fwrite(text_.data(), 1, text_.size(), stdout) == text_.size();
        text_.clear();
        if (!written || std::fflush(stdout) != 0) {
            return {errno, boost::system::generic_category()};
        }
        return {};
    }

    [[nodiscard]] std::uint64_t samples() const { return samples_; }

    void summarize() const {
        fmt::print(
            stderr,
            "sweepcast: {} samples; {} checksum errors, {} bytes skipped, {} packets lost\n",
            samples_,
            losses_.checksum_errors,
            losses_.skipped_bytes,
            losses_.lost_packets
        );
    }

private:
    void add(const Sample& sample) {
        const auto out = std::back_inserter(text_);
        const int quality = sample.quality;
        const int flag = sample.flag;
        if (units_) {
            // Enough digits to give back the lidar's own units.
            const auto degrees = sample.angle.degrees();
            const auto mm = sample.distance.millimetres();
            fmt::format_to(out, "{:.4f},{:.2f},{},{}\n", degrees, mm, quality, flag);
        } else {
            const auto angle = sample.angle.raw;
            fmt::format_to(out, "{},{},{},{}\n", angle, sample.distance.raw, quality, flag);
        }
    }

    void count(const protocol::DecodeEvent& event) {
        switch (event.kind) {
        case DecodeEventKind::checksum_error:
            losses_.checksum_errors += event.count;
            break;
        case DecodeEventKind::bytes_skipped:
            losses_.skipped_bytes += event.count;
            break;
        case DecodeEventKind::packets_lost:
            losses_.lost_packets += event.count;
            break;
        case DecodeEventKind::encoder_reset:
        case DecodeEventKind::scan_reset:
            break;  // no damage
        }
    }

    bool units_;
    std::string text_;
    std::uint64_t samples_{};
    protocol::LineLosses losses_;
};

/// Decodes all of `source`. Gives back how many bytes it held.
Result<std::uint64_t, Problem>
decode_all(ByteSource& source, protocol::Decoder& decoder, Printer& printer) {
    Decoded decoded;
    std::uint64_t bytes = 0;
    while (true) {
        const auto block = source.next();
        if (!block) {
            return block.error();
        }
        decoded.clear();
        decoder.push(*block, {}, decoded);
        if (const auto failed = printer.print(decoded)) {
            return Problem{failed, "cannot write to standard output: " + failed.message(), ""};
        }
        if (block->empty()) {
            return bytes;
        }
        bytes += block->size();
    }
}

int decode(const DecodeArguments& arguments) {
    const auto type = parse_answer_type(arguments.type);
    if (!type) {
        return report(type.error());
    }
    const auto source = open_byte_source(arguments.path);
    if (!source) {
        return report(source.error());
    }
    std::signal(SIGPIPE, SIG_IGN);  // a reader that goes is an error of a write
    auto decoder = protocol::Decoder::create(
        *type,
        {.sample_duration = std::chrono::microseconds{arguments.sample_us}}
    );
    Printer printer(arguments.units);
    const auto bytes = decode_all(**source, decoder.value(), printer);
    if (!bytes && bytes.error().code == boost::system::errc::broken_pipe) {
        return 1;  // the reader has had enough, as `| head`: nothing to tell anyone
    }
    if (!bytes) {
        return report(bytes.error());
    }
    printer.summarize();
    if (printer.samples() == 0) {
        return report(
            {make_error_code(boost::system::errc::invalid_argument),
             fmt::format("no samples of type {} in {} bytes", shown_answer_type(*type), *bytes),
             "is it another type? Known are " + known_answer_types()}
        );
    }
    return 0;
}

}  // namespace

void add_decode_command(CLI::App& app, int& exit_code) {
    auto arguments = std::make_shared<DecodeArguments>();
    auto& command =
        *app.add_subcommand("decode", "Decode raw measurement bytes from a file or a pipe to CSV");
    command
        .add_option(
            "file",
            arguments->path,
            "The bytes that followed the descriptor of a measurement stream; - is standard input"
        )
        ->capture_default_str();
    command
        .add_option(
            "--type",
            arguments->type,
            "Answer type, by number or name: " + known_answer_types()
        )
        ->required();
    command
        .add_option(
            "--sample-us",
            arguments->sample_us,
            "Microseconds from sample to sample, as the mode has it; dense capsules (0x85, 0x86) "
            "that turn faster than this allows are left out. 0: not known"
        )
        ->check(CLI::Range(0, 1'000'000))
        ->capture_default_str();
    command.add_flag("--units", arguments->units, "Print degrees and millimetres");
    command.footer(footer);
    command.callback([arguments, &exit_code] { exit_code = decode(*arguments); });
}

}  // namespace sweepcast::cli
