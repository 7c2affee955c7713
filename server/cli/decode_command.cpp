#include "server/cli/decode_command.hpp"

#include "driver/capture/capture_reader.hpp"
#include "driver/capture/stream_finder.hpp"
#include "driver/protocol/decode.hpp"
#include "server/cli/answer_type_names.hpp"
#include "server/cli/byte_source.hpp"
#include "server/cli/command.hpp"
#include "server/cli/print.hpp"
#include "server/cli/sample_printer.hpp"
#include "server/cli/source_stream.hpp"
#include "server/cli/stop_signals.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace sweepcast::cli {

namespace {

using capture::CaptureReader;
using protocol::Decoded;

constexpr const char* decode_footer = R"(
A capture, as `sweepcast capture` writes it, tells itself what it holds: its measurement streams are decoded one
after the other. Anything else is taken as the bytes of one stream, without its descriptor, and needs --type.

Prints a header line and then a line a sample, in the units of the line: angles in 1/65536 turn, distances in
quarter millimetres (0: no echo). Bit 0 of the flag is set where a revolution begins. What was damaged is told on
standard error. A capsule (0x82, 0x84, 0x85, 0x86) is complete with the beginning of the next one, so the samples
of the last one do not come out.

Examples:
  sweepcast decode bug.sweepcast > scan.csv
  zstd -dc bug.sweepcast.zst | sweepcast decode --units
  sweepcast decode --type 0x84 --sample-us 62.5 scan.bin > scan.csv
  cat /tmp/recorded | sweepcast decode --type 82 | head)";

struct DecodeArguments {
    std::string path{"-"};
    std::string type;
    std::optional<double> sample_us;
    bool units{};
};

std::chrono::nanoseconds in_ns(double microseconds) {
    return std::chrono::nanoseconds(std::llround(microseconds * 1e3));
}

/// What is wrong with standard output, if anything.
Result<void, Problem> print_samples(SamplePrinter& printer, const Decoded& decoded) {
    if (const auto failed = printer.print(decoded)) {
        return Problem{failed, "cannot write to standard output: " + failed.message(), ""};
    }
    return {};
}

Problem no_samples(std::string cause, std::string hint) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        std::move(cause),
        std::move(hint)};
}

/// What is wrong with --type for such a file, if anything.
std::optional<Problem> type_problem(const DecodeArguments& arguments, bool is_capture) {
    if (is_capture && !arguments.type.empty()) {
        return Problem{
            make_error_code(boost::system::errc::invalid_argument),
            arguments.path + " is a capture, which tells its answer types itself",
            "leave --type out"};
    }
    if (!is_capture && arguments.type.empty()) {
        return Problem{
            make_error_code(boost::system::errc::invalid_argument),
            arguments.path + " is no capture, so its answer type must be told",
            "give --type, one of " + known_answer_types()};
    }
    return std::nullopt;
}

/// Decodes all of `source`, which holds the bytes of one stream.
Result<void, Problem> decode_raw(
    ByteSource& source,
    protocol::AnswerType type,
    const DecodeArguments& arguments,
    SamplePrinter& printer
) {
    const auto sample_duration = in_ns(arguments.sample_us.value_or(0));
    auto decoder = protocol::Decoder::create(type, {.sample_duration = sample_duration});
    Decoded decoded;
    std::uint64_t bytes = 0;
    for (bool ended = false; !ended;) {
        const auto block = source.next();
        if (!block) {
            return block.error();
        }
        decoded.clear();
        decoder->push(*block, {}, decoded);
        if (auto printed = print_samples(printer, decoded); !printed) {
            return printed;
        }
        ended = block->empty();
        bytes += block->size();
    }
    printer.summarize();
    if (printer.samples() == 0) {
        return no_samples(
            fmt::format("no samples of type {} in {} bytes", shown_answer_type(type), bytes),
            "is it another type? Known are " + known_answer_types()
        );
    }
    return {};
}

void introduce(const capture::CaptureHeader& header) {
    print(
        stderr,
        "sweepcast: {} {}, firmware {}, mode {}, captured at {} by {}\n",
        header.model,
        header.serial.substr(0, 8),
        header.firmware,
        header.mode,
        header.started,
        header.program
    );
}

/// Decodes the streams of a capture, one after the other. Gives back how the capture ended.
Result<CaptureReader::End, Problem> decode_streams(
    CaptureReader& reader,
    std::chrono::nanoseconds sample_duration,
    SamplePrinter& printer
) {
    capture::StreamFinder finder;
    std::optional<protocol::Decoder> decoder;
    Decoded decoded;
    while (const auto record = reader.next()) {
        const auto block = finder.push(*record);
        if (!block) {
            continue;
        }
        if (block->begins) {
            auto made =
                protocol::Decoder::create(block->type, {.sample_duration = sample_duration});
            if (!made) {
                return Problem{
                    made.error(),
                    fmt::format("a stream of type {}", shown_answer_type(block->type)),
                    "known are " + known_answer_types()};
            }
            decoder.emplace(std::move(*made));
        }
        decoded.clear();
        decoder->push(block->bytes, {}, decoded);
        if (auto printed = print_samples(printer, decoded); !printed) {
            return printed.error();
        }
    }
    return reader.end();
}

Result<void, Problem>
decode_capture(ByteSource& source, const DecodeArguments& arguments, SamplePrinter& printer) {
    SourceStream in(source);
    auto reader = CaptureReader::open(in);
    if (!reader) {
        return in.problem().value_or(reader.error());
    }
    introduce(reader->header());
    const auto sample_duration =
        arguments.sample_us ? in_ns(*arguments.sample_us) : reader->header().sample_duration;
    const auto end = decode_streams(*reader, sample_duration, printer);
    if (!end) {
        return end.error();
    }
    if (in.problem()) {
        return *in.problem();
    }
    printer.summarize();
    if (*end == CaptureReader::End::damaged) {
        return no_samples(
            "the capture is damaged: what follows is not known",
            "what came before was decoded"
        );
    }
    if (*end == CaptureReader::End::cut_short) {
        print(stderr, "sweepcast: the capture ends inside a record; all before that was decoded\n");
    }
    if (printer.samples() == 0) {
        return no_samples(
            "there are no samples in this capture",
            "capture for some seconds longer"
        );
    }
    return {};
}

int decode(const DecodeArguments& arguments) {
    const auto type =
        arguments.type.empty() ? protocol::AnswerType::normal : parse_answer_type(arguments.type);
    if (!type) {
        return report_misuse(type.error());
    }
    auto opened = open_byte_source(arguments.path);
    if (!opened) {
        return report(opened.error());
    }
    ignore_write_signals();
    PeekSource source(std::move(*opened));
    const auto is_capture = source.begins_with(capture::magic);
    if (!is_capture) {
        return report(is_capture.error());
    }
    if (const auto problem = type_problem(arguments, *is_capture)) {
        return report_misuse(*problem);
    }
    SamplePrinter printer(arguments.units);
    const auto decoded = *is_capture ? decode_capture(source, arguments, printer)
                                     : decode_raw(source, *type, arguments, printer);
    if (!decoded && decoded.error().code == boost::system::errc::broken_pipe) {
        return 1;  // the reader has had enough, as `| head`: nothing to tell anyone
    }
    return decoded ? 0 : report(decoded.error());
}

}  // namespace

void add_decode_command(CLI::App& app, int& exit_code) {
    auto arguments = std::make_shared<DecodeArguments>();
    auto& command = *app.add_subcommand(
        "decode",
        "Decode a capture, or raw measurement bytes, from a file or a pipe to CSV"
    );
    command
        .add_option(
            "file",
            arguments->path,
            "A capture, or the bytes that followed a measurement stream's descriptor; - is "
            "standard "
            "input"
        )
        ->capture_default_str();
    command.add_option(
        "--type",
        arguments->type,
        "Answer type of raw bytes, by number or name: " + known_answer_types()
    );
    command
        .add_option(
            "--sample-us",
            arguments->sample_us,
            "Microseconds from sample to sample, as the mode has it, e.g. 31.25; dense capsules "
            "(0x85, 0x86) that turn faster than this allows are left out. 0: not known (default: "
            "as "
            "the capture says)"
        )
        ->check(CLI::Range(0.0, 1'000'000.0));
    command.add_flag("--units", arguments->units, "Print degrees and millimetres");
    command.footer(decode_footer);
    command.callback([arguments, &exit_code] { exit_code = decode(*arguments); });
}

}  // namespace sweepcast::cli
