#include "server/gateway/lidar_memory.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <boost/json/value.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace sweepcast::gateway {

namespace fs = std::filesystem;
namespace json = boost::json;

namespace {

/// Far more lidars than any machine has; a larger file is not ours.
constexpr std::size_t most_bytes = 256UL * 1024;
constexpr std::size_t most_lidars = 1000;

Problem unusable(const fs::path& file, std::string_view why) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("{}: {}", file.string(), why),
        "line speeds and lidars are looked for anew; remove the file if this comes back"};
}

Problem unwritable(const fs::path& file, std::string_view why) {
    return {
        make_error_code(boost::system::errc::io_error),
        fmt::format("{}: {}", file.string(), why),
        "lidars are not remembered; name a folder that can be written with --state-dir"};
}

/// The file's text, empty if there is none.
Result<std::string, Problem> read_text(const fs::path& path) {
    std::error_code absent;
    const auto status = fs::status(path, absent);
    if (!fs::exists(status)) {
        return std::string();
    }
    std::ifstream file(path, std::ios::binary);
    if (!fs::is_regular_file(status) || !file) {
        return unusable(path, "it cannot be read");
    }
    std::string text(most_bytes + 1, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text.size() > most_bytes) {
        return unusable(path, "it is too large");
    }
    return text;
}

/// Whether a port's path can name a lidar from one run to the next. The number of a pseudo terminal
/// is somebody else's by then.
bool names_one(std::string_view port) {
    return !port.empty() && !port.starts_with("/dev/pts/");
}

const json::string* text_in(const json::object& entry, std::string_view key) {
    const auto* value = entry.if_contains(key);
    return value != nullptr ? value->if_string() : nullptr;
}

}  // namespace

Result<void, Problem> LidarMemory::open(fs::path file) {
    const std::lock_guard lock(mutex_);
    file_ = std::move(file);
    lidars_.clear();
    const auto text = read_text(file_);
    if (!text) {
        return text.error();
    }
    if (text->empty()) {
        return {};
    }
    boost::system::error_code malformed;
    const auto parsed = json::parse(*text, malformed);
    const auto* const root = malformed ? nullptr : parsed.if_object();
    const auto* const list = root != nullptr ? root->if_contains("lidars") : nullptr;
    if (list == nullptr || !list->is_array()) {
        return unusable(file_, "it is not a list of lidars");
    }
    for (const auto& item : list->get_array()) {
        const auto* const entry = item.if_object();
        const auto* const serial = entry != nullptr ? text_in(*entry, "serial") : nullptr;
        const auto* const port = entry != nullptr ? text_in(*entry, "port") : nullptr;
        const auto* const baud = entry != nullptr ? entry->if_contains("baud") : nullptr;
        if (serial == nullptr || port == nullptr || baud == nullptr ||
            lidars_.size() >= most_lidars) {
            continue;
        }
        boost::system::error_code no_number;
        const auto speed = baud->to_number<std::uint32_t>(no_number);
        if (!no_number) {
            const auto* const home = text_in(*entry, "home");
            lidars_[std::string(*serial)] = {
                std::string(*port),
                speed,
                home != nullptr ? std::string(*home) : std::string()};
        }
    }
    return {};
}

std::vector<std::uint32_t> LidarMemory::baud_hints(const std::string& port) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::pair<int, std::uint32_t>> ranked;  // how much speaks for it, speed
    for (const auto& [serial, entry] : lidars_) {
        constexpr int named_by_it = 1'000'000;
        constexpr int last_met_there = 2 * named_by_it;
        const int weight = 1 + (entry.port == port ? last_met_there : 0) +
                           (!port.empty() && entry.home == port ? named_by_it : 0);
        const auto known =
            std::ranges::find(ranked, entry.baud, [](const auto& each) { return each.second; });
        if (known != ranked.end()) {
            known->first += weight;
        } else {
            ranked.emplace_back(weight, entry.baud);
        }
    }
    std::ranges::stable_sort(ranked, std::ranges::greater{}, [](const auto& each) {
        return each.first;
    });
    std::vector<std::uint32_t> bauds(ranked.size());
    std::ranges::transform(ranked, bauds.begin(), [](const auto& each) { return each.second; });
    return bauds;
}

std::optional<RememberedLidar> LidarMemory::lidar_named_by(const std::string& port) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find_if(lidars_, [&](const auto& each) {
        return names_one(port) && each.second.home == port;
    });
    if (found == lidars_.end()) {
        return std::nullopt;
    }
    return RememberedLidar{found->first, found->second.baud};
}

/// The home to keep: none for a serial number that two lidars have, which would be taken for each
/// other in the next run.
std::string LidarMemory::settle_home(const std::string& serial, const std::string& home) {
    if (!names_one(home)) {
        const auto known = lidars_.find(serial);
        return known != lidars_.end() ? known->second.home : std::string();
    }
    if (!homes_.contains(serial) && homes_.size() >= most_lidars) {
        return {};  // a device can make up serial numbers without end
    }
    auto& noted = homes_.try_emplace(serial, home).first->second;
    if (noted != home) {
        noted.clear();
    }
    return noted;
}

Result<void, Problem> LidarMemory::note(
    const std::string& serial,
    const std::string& port,
    std::uint32_t baud,
    const std::string& home
) {
    const std::lock_guard lock(mutex_);
    if (file_.empty()) {
        return {};
    }
    const Entry entry{port, baud, settle_home(serial, home)};
    const auto known = lidars_.find(serial);
    if ((known != lidars_.end() && known->second == entry) ||
        (known == lidars_.end() && lidars_.size() >= most_lidars)) {
        return {};
    }
    // A port has one lidar: what was there before is elsewhere now. And it names one.
    for (auto& [other, place] : lidars_) {
        if (place.port == port) {
            place.port.clear();
        }
        if (place.home == entry.home) {
            place.home.clear();
        }
    }
    lidars_[serial] = entry;
    return write();
}

/// Writes a new file and puts it in the place of the old one, so that there always is a whole one.
Result<void, Problem> LidarMemory::write() const {
    json::array list;
    for (const auto& [serial, entry] : lidars_) {
        list.push_back(
            {{"serial", serial}, {"port", entry.port}, {"baud", entry.baud}, {"home", entry.home}}
        );
    }
    const json::object root{{"lidars", std::move(list)}};
    std::error_code failure;
    if (file_.has_parent_path()) {
        fs::create_directories(file_.parent_path(), failure);
    }
    if (failure) {
        return unwritable(file_, failure.message());
    }
    auto fresh = file_;
    fresh += ".new";
    {
        errno = 0;
        std::ofstream out(fresh, std::ios::binary | std::ios::trunc);
        out << json::serialize(root) << '\n';
        out.close();
        if (!out) {
            return unwritable(file_, std::generic_category().message(errno));
        }
    }
    fs::rename(fresh, file_, failure);
    if (failure) {
        return unwritable(file_, failure.message());
    }
    return {};
}

fs::path default_memory_file() {
    constexpr const char* name = "lidars.json";
    struct Place {
        const char* variable;
        const char* below;
    };
    constexpr std::array places{
        Place{"STATE_DIRECTORY", ""},
        Place{"XDG_STATE_HOME", "sweepcast"},
        Place{"HOME", ".local/state/sweepcast"}};
    for (const auto& place : places) {
        const char* const value = std::getenv(place.variable);
        if (value != nullptr && fs::path(value).is_absolute()) {
            return fs::path(value) / place.below / name;
        }
    }
    return {};
}

}  // namespace sweepcast::gateway
