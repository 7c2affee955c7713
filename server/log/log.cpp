#include "server/log/log.hpp"

#include "driver/protocol/printable.hpp"

#include <spdlog/details/log_msg.h>
#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace sweepcast::log {

namespace {

spdlog::level::level_enum level_of_new_loggers = spdlog::level::info;

using Base = spdlog::sinks::ansicolor_stderr_sink_mt;

/// Standard error. Messages quote lidars, peers and files, so each is made printable here.
class PrintableSink final : public Base {
public:
    void log(const spdlog::details::log_msg& message) override {
        const auto name = printable(message.logger_name);
        const auto text = printable(message.payload);
        auto shown = message;
        shown.logger_name = name;
        shown.payload = text;
        Base::log(shown);
    }

private:
    static std::string printable(spdlog::string_view_t text) {
        return protocol::printable({text.data(), text.size()});
    }
};

std::shared_ptr<spdlog::sinks::sink> the_sink() {
    static const auto sink = std::make_shared<PrintableSink>();
    return sink;
}

}  // namespace

bool set_level(const std::string& level) {
    constexpr std::array<std::string_view, 4> names{"debug", "info", "warning", "error"};
    if (std::ranges::find(names, level) == names.end()) {
        return false;
    }
    level_of_new_loggers = spdlog::level::from_str(level);
    return true;
}

std::shared_ptr<spdlog::logger> make_logger(const std::string& part) {
    auto logger = std::make_shared<spdlog::logger>(part, the_sink());
    logger->set_level(level_of_new_loggers);
    logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %^%-7l%$ [%n] %v");
    return logger;
}

}  // namespace sweepcast::log
