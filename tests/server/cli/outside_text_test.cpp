// What lidars, peers and files say is printed, not obeyed.
#include "server/cli/command.hpp"
#include "server/cli/doctor_output.hpp"
#include "server/cli/watch_output.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>

namespace sweepcast::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Clears the screen, begins a line, and sets the terminal's title.
const std::string evil = "\x1b[2J\nforged\x9b\x07";
const std::string shown = R"(\u001b[2J\nforged\x9b\u0007)";
const std::string evil_utf8 = "\x1b[2J\nforged\xc2\x9b\x07";
const std::string shown_utf8 = R"(\u001b[2J\nforged\u009b\u0007)";

client::Connected greeting() {
    client::Connected connected;
    auto& lidar = *connected.hello.add_lidars();
    lidar.set_id(evil_utf8);
    lidar.mutable_device()->set_model(evil_utf8);
    lidar.set_mode(evil_utf8);
    lidar.set_cause(evil_utf8);
    return connected;
}

client::Scan scan() {
    client::Scan scan;
    scan.lidar = evil_utf8;
    scan.scan.mode = evil_utf8;
    scan.scan.sweep.samples.push_back({{}, {4000}, {100}, 188, 1});
    return scan;
}

TEST(OutsideText, OfAProblemIsPrintable) {
    testing::internal::CaptureStderr();
    report({{}, evil, evil});
    EXPECT_EQ(
        testing::internal::GetCapturedStderr(),
        "sweepcast: " + shown + "\n  " + shown + "\n"
    );
}

TEST(OutsideText, InTheTableIsPrintable) {
    const auto output = make_table_output();
    testing::internal::CaptureStdout();
    output->on_connected(greeting());
    output->on_disconnected({{{}, evil, ""}, {}});
    const auto printed = testing::internal::GetCapturedStdout();
    const auto row = shown_utf8 + " " + shown_utf8 + " UNKNOWN         " + shown_utf8 + " ";
    EXPECT_THAT(printed, HasSubstr("\n" + row));
    EXPECT_THAT(printed, HasSubstr("  " + shown_utf8 + "\n"));
    EXPECT_THAT(printed, HasSubstr("\n" + shown + "; trying again\n"));
}

TEST(OutsideText, InCsvIsPrintable) {
    const auto output = make_csv_output(false);
    testing::internal::CaptureStdout();
    output->on_scan(scan());
    EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("\n" + shown_utf8 + ",0,"));
}

TEST(OutsideText, InCsvIsOneField) {
    auto sweep = scan();
    sweep.lidar = "A,\"B\"";
    const auto output = make_csv_output(false);
    testing::internal::CaptureStdout();
    output->on_scan(sweep);
    EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("\n\"A,\"\"B\"\"\",0,"));
}

TEST(OutsideText, InJsonIsPrintableAndMeansTheSame) {
    auto sweep = scan();
    // Isolates, which the JSON of protobuf leaves as they are.
    sweep.lidar = "\xe2\x81\xa6 A\xe2\x81\xa9";
    const auto output = make_json_output();
    testing::internal::CaptureStdout();
    output->on_scan(sweep);
    EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr(R"("\u2066 A\u2069")"));
}

TEST(OutsideText, InNotesIsPrintable) {
    const auto output = make_csv_output(false);
    testing::internal::CaptureStderr();
    output->on_disconnected({{{}, evil, ""}, {}});
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "sweepcast: " + shown + "; trying again\n");
}

std::string doctor_prints(bool colour) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
    DoctorText text(file.get(), colour);
    text.begin(evil);
    text.check({"bytes", "Bytes come", device::Verdict::failed, evil});
    device::Diagnosis diagnosis;
    diagnosis.checks = {{"bytes", "Bytes come", device::Verdict::failed, evil}};
    diagnosis.cause = evil;
    diagnosis.likely_causes = {evil};
    diagnosis.next_steps = {evil};
    text.conclude(diagnosis);
    std::rewind(file.get());
    std::string printed(4096, '\0');
    printed.resize(std::fread(printed.data(), 1, printed.size(), file.get()));
    return printed;
}

TEST(OutsideText, OfADiagnosisIsPrintable) {
    const auto printed = doctor_prints(false);
    EXPECT_THAT(printed, HasSubstr("Examining " + shown + "\n"));
    EXPECT_THAT(printed, HasSubstr("  FAIL  Bytes come: " + shown + "\n"));
    EXPECT_THAT(printed, HasSubstr("What is wrong: " + shown + "\n"));
    EXPECT_THAT(printed, HasSubstr("  1. " + shown + "\n"));
    EXPECT_THAT(printed, Not(HasSubstr("\x1b")));
}

TEST(OutsideText, OfADiagnosisIsPrintableWhereOursIsColoured) {
    const auto printed = doctor_prints(true);
    EXPECT_THAT(printed, HasSubstr("\x1b[1mExamining " + shown + "\x1b[0m\n"));
    EXPECT_THAT(printed, Not(HasSubstr("\x1b[2J")));
}

}  // namespace
}  // namespace sweepcast::cli
