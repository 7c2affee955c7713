// Fault commands: how they are read, and how they are written.
#include "driver/virtual/fault_command.hpp"

#include "driver/virtual/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

using testing::HasSubstr;

struct Case {
    const char* text;
    FaultCommand command;
};

TEST(ParseFaultCommand, ReadsEachAndWritesItAgain) {
    for (const auto& [text, command] : {
             Case{"unplug", Unplug{}},
             Case{"replug", Replug{}},
             Case{"replug /tmp/a lidar", Replug{"/tmp/a lidar"}},
             Case{"fault mute", SetFault{"mute"}},
             Case{"fault noise=0.02", SetFault{"noise=0.02"}},
             Case{"clear", ClearFault{}},
             Case{"clear noise", ClearFault{"noise"}},
             Case{"banner", Suffer{Incident::banner, 0}},
             Case{"reboot", Suffer{Incident::reboot, 0}},
             Case{"protection-stop=32769", Suffer{Incident::protection_stop, 0x8001}},
             Case{"half-answer", Suffer{Incident::half_answer, 0}},
             Case{"angle-restart", Suffer{Incident::angle_restart, 0}},
             Case{"loss=7", Suffer{Incident::loss, 7}},
         }) {
        const auto parsed = parse_fault_command(text);
        ASSERT_TRUE(parsed) << text << ": " << parsed.error().cause;
        EXPECT_EQ(*parsed, command) << text;
        EXPECT_EQ(to_text(*parsed), text);
    }
}

TEST(ParseFaultCommand, TakesSpacesAndUsualValues) {
    EXPECT_EQ(*parse_fault_command("  fault   noise=1 \r"), FaultCommand(SetFault{"noise=1"}));
    EXPECT_EQ(*parse_fault_command("\tunplug "), FaultCommand(Unplug{}));
    EXPECT_EQ(
        *parse_fault_command("protection-stop"),
        FaultCommand(Suffer{Incident::protection_stop, 1})
    );
    EXPECT_EQ(
        *parse_fault_command("protection-stop=0x8001"),
        FaultCommand(Suffer{Incident::protection_stop, 0x8001})
    );
    EXPECT_EQ(*parse_fault_command("loss"), FaultCommand(Suffer{Incident::loss, 10}));
}

struct Mistake {
    std::string text;
    std::string cause;
    const char* hint;
};

TEST(ParseFaultCommand, SaysWhatIsWrongAndWhatCanBeWritten) {
    for (const auto& [text, cause, hint] : {
             Mistake{"", "no command \"\"", "unplug, replug [LINK_PATH]"},
             Mistake{"unplugged", "no command \"unplugged\"", "unplug"},
             Mistake{"unplug now", "unplug now", "nothing follows"},
             Mistake{"fault", "fault NAME[=VALUE]", "fault noise=0.02"},
             Mistake{"fault nosie=1", "nosie", "noise=RATE"},
             Mistake{"fault noise=2", "noise=2", "RATE is 0 to 1"},
             Mistake{"clear nosie", "nosie", "noise"},
             Mistake{"clear noise=1", "noise=1", "noise"},
             Mistake{"reboot=1", "reboot=1", "CODE"},
             Mistake{"loss=0", "loss=0", "1 to 1000000"},
             Mistake{"loss=1000001", "loss=", "1 to 1000000"},
             Mistake{"protection-stop=", "protection-stop=", "0x8001"},
             Mistake{std::string("\x1b[31m\n"), "\\u001b[31m", "unplug"},
             Mistake{std::string(2000, 'x'), "xxx...", "1024"},
             Mistake{std::string(63, 'x') + "éa", "\"" + std::string(63, 'x') + "...\"", "unplug"},
             Mistake{std::string(500, '\x1b'), "\\u001b...", "unplug"},
         }) {
        const auto parsed = parse_fault_command(text);
        ASSERT_FALSE(parsed) << text;
        EXPECT_EQ(parsed.error().code, errc::invalid_option);
        EXPECT_THAT(parsed.error().cause, HasSubstr(cause));
        EXPECT_THAT(parsed.error().hint, HasSubstr(hint));
        EXPECT_LT(parsed.error().cause.size(), 200U);
        EXPECT_EQ(parsed.error().cause.find('\n'), std::string::npos);
    }
}

TEST(FaultCommandsHelp, NamesEveryCommand) {
    for (const auto* name :
         {"unplug", "replug", "fault", "clear", "banner", "reboot", "angle-restart", "loss"}) {
        EXPECT_THAT(fault_commands_help(), HasSubstr(std::string("  ") + name));
    }
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
