// Walks /sys/class/tty: each entry leads to its USB adapter, whose files say what it is.
#include "driver/link/port_list.hpp"

#include "driver/link/small_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

namespace sweepcast::link {

namespace fs = std::filesystem;

namespace {

constexpr std::uint16_t silicon_labs = 0x10c4;
constexpr std::uint16_t qinheng = 0x1a86;
constexpr std::array<std::pair<std::uint16_t, std::uint16_t>, 9> lidar_adapters{{
    {silicon_labs, 0xea60},  // CP2102, CP2104: what Slamtec ships
    {silicon_labs, 0xea61},
    {silicon_labs, 0xea63},
    {silicon_labs, 0xea70},  // CP2105
    {qinheng, 0x7523},       // CH340: on later boards and clones
    {qinheng, 0x7522},
    {qinheng, 0x5523},  // CH341
    {qinheng, 0x55d3},  // CH343
    {qinheng, 0x55d4},  // CH9102
}};

std::optional<std::uint16_t> read_hex(const fs::path& path) {
    const std::string text = read_line(path);
    std::uint16_t value{};
    const auto [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (ec != std::errc{} || end != text.data() + text.size()) {
        return std::nullopt;
    }
    return value;
}

/// The directory of the USB device that `device`, a directory below it, belongs to.
std::optional<fs::path> usb_device_of(const fs::path& device) {
    std::error_code ec;
    fs::path place = fs::canonical(device, ec);
    while (!ec && place.has_relative_path()) {
        if (fs::exists(place / "idVendor", ec)) {
            return place;
        }
        place = place.parent_path();
    }
    return std::nullopt;
}

/// The links that udev makes in /dev/serial/by-id or by-path: name of the device file -> link.
std::map<std::string, std::string> udev_links(const fs::path& directory) {
    std::map<std::string, std::string> links;
    std::error_code ec;
    for (fs::directory_iterator entry(directory, ec), end; !ec && entry != end;
         entry.increment(ec)) {
        std::error_code not_a_link;
        const fs::path target = fs::read_symlink(entry->path(), not_a_link);
        if (!not_a_link) {
            links.emplace(target.filename().string(), entry->path().string());
        }
    }
    return links;
}

std::string link_of(const std::map<std::string, std::string>& links, const std::string& name) {
    const auto found = links.find(name);
    return found == links.end() ? std::string{} : found->second;
}

std::optional<SerialPort> describe(const fs::path& tty, const fs::path& dev) {
    std::error_code ec;
    const fs::path file = dev / tty.filename();
    const auto adapter = usb_device_of(tty / "device");
    if (!adapter || !fs::exists(file, ec)) {
        return std::nullopt;
    }
    const auto vendor = read_hex(*adapter / "idVendor");
    const auto product = read_hex(*adapter / "idProduct");
    if (!vendor || !product) {
        return std::nullopt;
    }
    SerialPort port;
    port.path = file.string();
    port.vendor_id = *vendor;
    port.product_id = *product;
    port.driver = fs::read_symlink(tty / "device" / "driver", ec).filename().string();
    port.product = read_line(*adapter / "product");
    port.serial = read_line(*adapter / "serial");
    return port;
}

}  // namespace

std::vector<SerialPort> list_usb_ports(const SystemRoots& roots) {
    std::vector<SerialPort> ports;
    const auto by_id = udev_links(roots.dev / "serial" / "by-id");
    const auto by_path = udev_links(roots.dev / "serial" / "by-path");
    std::error_code ec;
    const fs::path ttys = roots.sysfs / "class" / "tty";
    for (fs::directory_iterator entry(ttys, ec), end; !ec && entry != end; entry.increment(ec)) {
        if (auto port = describe(entry->path(), roots.dev)) {
            const std::string name = entry->path().filename().string();
            port->by_id = link_of(by_id, name);
            port->by_path = link_of(by_path, name);
            ports.push_back(std::move(*port));
        }
    }
    std::sort(ports.begin(), ports.end(), [](const SerialPort& a, const SerialPort& b) {
        return a.path < b.path;
    });
    return ports;
}

std::vector<SerialPort> list_candidate_ports(const SystemRoots& roots) {
    auto ports = list_usb_ports(roots);
    std::erase_if(ports, [](const SerialPort& port) {
        return !is_lidar_adapter(port.vendor_id, port.product_id);
    });
    return ports;
}

bool is_lidar_adapter(std::uint16_t vendor_id, std::uint16_t product_id) {
    return std::find(
               lidar_adapters.begin(),
               lidar_adapters.end(),
               std::pair{vendor_id, product_id}
           ) != lidar_adapters.end();
}

}  // namespace sweepcast::link
