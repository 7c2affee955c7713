#include "server/log/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace sweepcast::log {

namespace {

spdlog::level::level_enum level_of_new_loggers = spdlog::level::info;

std::shared_ptr<spdlog::sinks::sink> the_sink() {
    static const auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
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
