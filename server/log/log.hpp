// The program's log: one sink on standard error, a logger for each part.
#pragma once

#include <spdlog/logger.h>

#include <memory>
#include <string>

namespace sweepcast::log {

/// Sets the level of all loggers made from now on: "debug", "info", "warning" or "error". False if
/// it is none of these.
[[nodiscard]] bool set_level(const std::string& level);

/// Returns a logger whose lines carry the part's name. Each message is one printable line, whatever
/// it quotes. Safe from any thread.
[[nodiscard]] std::shared_ptr<spdlog::logger> make_logger(const std::string& part);

}  // namespace sweepcast::log
